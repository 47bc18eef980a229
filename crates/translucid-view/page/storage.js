// What the browser keeps for the next time; nothing where it does not let us.

const PREFIX = "translucid.";

export function recall(key, otherwise = null) {
    try {
        const text = localStorage.getItem(PREFIX + key);
        return text === null ? otherwise : JSON.parse(text);
    } catch {
        return otherwise;
    }
}

export function keep(key, value) {
    try {
        localStorage.setItem(PREFIX + key, JSON.stringify(value));
    } catch {
        // A private window, or storage that is full: the page works without.
    }
}
