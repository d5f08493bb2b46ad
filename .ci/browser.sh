# For scripts beside it: Chromium in $browser, and `drawn`. Without Chromium the script ends, and
# says that nothing was checked.
check=$(basename "$0")

find_browser() {
    command -v chromium || command -v chromium-browser || command -v google-chrome
}

if ! browser=$(find_browser) && [ "$(id -u)" = 0 ] && command -v apt-get > /dev/null; then
    echo "$check: installing Chromium"
    export DEBIAN_FRONTEND=noninteractive
    packages="chromium fonts-dejavu-extra" # DejaVu has the letters of mathematics
    timeout 400 sh -c "apt-get update && apt-get install --yes --no-install-recommends $packages" \
        > /dev/null 2>&1 || true
    browser=$(find_browser) || true
fi
if [ -z "$browser" ]; then
    echo "$check: SKIPPED, for there is no Chromium: how browsers draw the pages is untested"
    exit 0
fi

# drawn FOLDER OPTIONS PAGE: print the page after its scripts; the profile is in the folder.
drawn() {
    local folder=$1
    shift
    timeout 300 "$browser" --headless --no-sandbox --disable-gpu --disable-quic --no-first-run \
        --disable-background-networking --disable-component-update --disable-sync \
        --user-data-dir="$folder/profile" --dump-dom "$@" 2> "$folder/log" \
        || { cat "$folder/log" >&2; echo "$check: $browser failed" >&2; exit 1; }
}
