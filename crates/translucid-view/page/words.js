// Messages in the words of the page.

/** The parts of a value that has several, such as a color. */
export const COLOR_PARTS = ["red", "green", "blue"];

/**
 * A message about a key of scene files, such as "material ball: subsurface_color[0] is 2, but \u2026", about the label that the key
 * has on the page: "Surface albedo red is 2, but \u2026". `labels` has the label of each key; other messages stay.
 */
export function inWords(message, labels, parts = COLOR_PARTS) {
    const found = message.match(/^(?:[^:]*: )?(\w+)(?:\[(\d)\])? (?:(is|has) (.*)|= (.*?): (must .*))$/s);
    if (!found || !Object.hasOwn(labels, found[1])) return message;
    const [, key, number, verb, rest, value, demand] = found;
    const part = number === undefined ? "" : ` ${parts[number] ?? Number(number) + 1}`;
    return `${labels[key]}${part} ${verb ? `${verb} ${rest}` : `is ${value}, but ${demand}`}`;
}
