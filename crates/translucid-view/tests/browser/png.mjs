// Reads the PNG files that the command writes: eight bits, color with or without alpha.

import { inflateSync } from "node:zlib";

/** Width, height and codes, four for each pixel. */
export function decode(file) {
    const chunks = [];
    for (let at = 8; at < file.length;) {
        const size = file.readUInt32BE(at);
        chunks.push({ type: file.toString("latin1", at + 4, at + 8), data: file.subarray(at + 8, at + 8 + size) });
        at += size + 12;
    }
    const header = chunks.find(({ type }) => type === "IHDR").data;
    const [width, height, depth, color] = [header.readUInt32BE(0), header.readUInt32BE(4), header[8], header[9]];
    const channels = { 2: 3, 6: 4 }[color];
    if (depth !== 8 || !channels || header[12] !== 0) throw new Error(`a PNG of color type ${color}, depth ${depth}`);
    const data = inflateSync(Buffer.concat(chunks.filter(({ type }) => type === "IDAT").map(({ data }) => data)));
    const stride = width * channels;
    const codes = Buffer.alloc(width * height * 4, 255);
    let above = Buffer.alloc(stride);
    for (let y = 0; y < height; y++) {
        const at = y * (stride + 1);
        const line = unfilter(data[at], data.subarray(at + 1, at + 1 + stride), above, channels);
        for (let x = 0; x < width; x++) line.copy(codes, 4 * (y * width + x), x * channels, (x + 1) * channels);
        above = line;
    }
    return { width, height, codes };
}

/** A line of bytes from their differences; `left`, `up` and `corner` are the bytes around each. */
function unfilter(kind, line, above, channels) {
    for (let i = 0; i < line.length; i++) {
        const left = i < channels ? 0 : line[i - channels];
        const up = above[i];
        const corner = i < channels ? 0 : above[i - channels];
        line[i] += [0, left, up, (left + up) >> 1, paeth(left, up, corner)][kind];
    }
    return line;
}

function paeth(left, up, corner) {
    const guess = left + up - corner;
    const [a, b, c] = [left, up, corner].map((value) => Math.abs(guess - value));
    return a <= b && a <= c ? left : b <= c ? up : corner;
}
