"use strict";
// Light or dark: like the page that contains this one in a frame, if its theme is known, else like the system.

const system = matchMedia("(prefers-color-scheme: dark)");
const around = () => {
    try {
        return parent === window ? null : parent.document.documentElement;
    } catch { // another site
        return null;
    }
};
const isDark = () => {
    const theme = around()?.dataset.theme;
    return theme === "dark" || (theme !== "light" && system.matches);
};
const THEMES = {
    light: { mesh: "#d9dee2", ball: "#eef1f3", lines: "#c3ccd4", ink: "#1f2933" },
    dark: { mesh: "#59646e", ball: "#2b333b", lines: "#4d5a66", ink: "#e3e8ec" },
};
let theme = THEMES.light;

function setTheme() {
    const name = isDark() ? "dark" : "light";
    theme = THEMES[name];
    document.documentElement.dataset.theme = name;
}

/** Call `action` whenever the theme changes between light and dark. */
function onTheme(action) {
    const changed = () => { const before = theme; setTheme(); if (theme !== before) action(); };
    system.addEventListener("change", changed);
    const root = around();
    if (root) new MutationObserver(changed).observe(root, { attributeFilter: ["data-theme"] });
}

setTheme();
