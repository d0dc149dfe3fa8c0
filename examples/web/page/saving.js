// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The tmini authors

// Saves the lidar's bytes, the picture and the points.

// "2026-05-04-130501", for names of files.
function stamp() {
    const now = new Date();
    const two = (number) => String(number).padStart(2, '0');
    const day = [now.getFullYear(), two(now.getMonth() + 1), two(now.getDate())].join('-');
    return `${day}-${two(now.getHours())}${two(now.getMinutes())}${two(now.getSeconds())}`;
}

// Offers `parts` as a download; returns the file's name.
export function save(kind, extension, parts, type) {
    const link = document.createElement('a');
    link.download = `tmini-${kind}-${stamp()}.${extension}`;
    link.href = URL.createObjectURL(new Blob(parts, { type }));
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    return link.download;
}

// The time of the bytes that are always kept, in milliseconds.
const KEPT_MS = 10000;

// Keeps the lidar's bytes, with times, as a recording for `tmini`: all since it was started, and always those of the
// last seconds.
export class Recorder {
    isRunning = false;
    bytes = 0;
    #library;
    #chunks = []; // [time, bytes]

    constructor(library) {
        this.#library = library;
    }

    start() {
        this.isRunning = true;
        this.bytes = 0;
        this.#chunks = [];
    }

    clear() {
        this.#chunks = [];
    }

    add(bytes, now = performance.now()) {
        const { CHUNK_MAX } = this.#library.constants;
        this.bytes += bytes.length;
        for (let from = 0; from < bytes.length; from += CHUNK_MAX) {
            this.#chunks.push([now, bytes.slice(from, from + CHUNK_MAX)]);
        }
        while (!this.isRunning && this.#chunks[0][0] < now - KEPT_MS) {
            this.#chunks.shift();
        }
    }

    // Ends and saves; returns the file's name.
    stop() {
        this.isRunning = false;
        return save('recording', 'tmini', this.parts(), 'application/octet-stream');
    }

    // All that is kept, in the tool's format of timed recordings.
    parts() {
        const library = this.#library;
        const { CHUNK_MAGIC_SIZE, CHUNK_HEAD_SIZE } = library.constants;
        const begun = this.#chunks[0]?.[0] ?? 0;
        let timeUs = 0; // The time of the chunk before, as rounded: so rounding errors do not add up.
        return [library.bytes(CHUNK_MAGIC_SIZE, 'recording_magic'), ...this.#chunks.flatMap(([time, bytes]) => {
            const passedUs = Math.round((time - begun) * 1000) - timeUs;
            timeUs += passedUs;
            library.hand(bytes);
            return [library.bytes(CHUNK_HEAD_SIZE, 'recording_head', passedUs, bytes.length), bytes];
        })];
    }
}
