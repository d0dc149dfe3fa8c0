// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The tmini authors

// A recording, completely in memory, played at the speed at which it was received. The formats are those of the tmini
// tool: the lidar's bytes, or the same in chunks with time stamps.

import { recordingProblems } from './problems.js';

const CSV_HEADER = 'scan,packet,point,angle_deg,distance_mm,intensity,flag,time_ms,frequency_hz';

export class Recording {
    kind = 'recording';
    #library;
    #bytes;
    #at = 0; // How many of the bytes have been fed.
    #isShown;
    #atEnd = false;

    // `isShown`: the page shows the scans while it is played.
    constructor(library, name, bytes, isShown = true) {
        this.#library = library;
        this.#bytes = bytes;
        this.#isShown = isShown;
        this.name = name;
        const scans = this.#survey();
        this.numbers = library.numbers('recording_numbers');
        this.durationMs = library.call('recording_time_ms');
        this.problem = this.#verdict(scans);
        this.rewind();
    }

    rewind() {
        this.#at = 0;
        this.#atEnd = false;
        this.#library.call('recording_rewind', this.#isShown ? 1 : 0);
    }

    get timeMs() {
        return this.#library.call('recording_time_ms');
    }

    get atEnd() {
        return this.#atEnd;
    }

    // Plays on until `timeMs`; returns how many scans were completed. The last packet may be shorter than a
    // millisecond, so the end is reached only when no packet is left.
    playUntil(timeMs) {
        const { TAPE_SCAN, TAPE_END } = this.#library.constants;
        const untilMs = timeMs >= this.durationMs ? Infinity : timeMs;
        let scans = 0;
        while (!this.#atEnd && this.timeMs < untilMs) {
            const next = this.#next();
            this.#atEnd = next === TAPE_END;
            scans += next === TAPE_SCAN ? 1 : 0;
        }
        return scans;
    }

    // Goes to another moment by playing from the beginning, which is fast enough.
    seek(timeMs) {
        this.rewind();
        return this.playUntil(timeMs);
    }

    // All samples of all valid packets, as `tmini decode --csv` prints them.
    csv() {
        const { TAPE_END } = this.#library.constants;
        const timeMs = this.timeMs;
        const lines = [CSV_HEADER];
        this.rewind();
        while (this.#next() !== TAPE_END) {
            this.#addRows(lines);
        }
        this.seek(timeMs);
        return `${lines.join('\n')}\n`;
    }

    #addRows(lines) {
        const { count, packet, scan, timeMs, frequencyChz } = this.#library.numbers('recording_packet_numbers');
        const points = this.#library.points('recording_points', count);
        const hz = frequencyChz > 0 ? (frequencyChz / 100).toFixed(2) : '';
        for (let i = 0; i < count; i++) {
            lines.push(`${scan},${packet},${points.csv(i)},${timeMs},${hz}`);
        }
    }

    // The next packet; feeds the bytes that the library needs.
    #next() {
        const { TAPE_NEEDS_BYTES } = this.#library.constants;
        for (;;) {
            const next = this.#library.call('recording_next');
            if (next !== TAPE_NEEDS_BYTES) {
                return next;
            }
            const part = this.#bytes.subarray(this.#at, this.#at + this.#library.transferSize);
            this.#library.hand(part);
            this.#at += this.#library.call('recording_feed', part.length);
        }
    }

    #survey() {
        this.rewind();
        return this.playUntil(Infinity);
    }

    #verdict(scans) {
        const { bytes, packets, version, damages } = this.numbers;
        if (version > this.#library.constants.CHUNK_VERSION) {
            return recordingProblems.tooNew(this.name, version);
        }
        if (bytes === 0) {
            return recordingProblems.empty(this.name);
        }
        if (packets === 0) {
            return recordingProblems.none(this.name, bytes);
        }
        if (scans === 0) {
            return recordingProblems.noScan(this.name, packets);
        }
        return damages > 0 ? recordingProblems.damaged(this.name, damages) : null;
    }
}
