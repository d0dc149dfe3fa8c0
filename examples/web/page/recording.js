// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The tmini authors

// A recording: all bytes at hand, played at the speed at which they came. Like the tmini tool's: bytes as
// the lidar sent them, or the same in chunks with their times.

import { recordingProblems } from './problems.js';

const CSV_HEADER = 'scan,packet,point,angle_deg,distance_mm,intensity,flag,time_ms,frequency_hz';

// A timed recording begins so; then come chunks: microseconds since the one before (32 bits, the least
// significant byte first), how many bytes follow (16 bits, likewise), these bytes.
export const MAGIC = Uint8Array.of(0x89, 0x74, 0x6D, 0x69, 0x6E, 0x69, 1, 0x0A);
const VERSION_AT = 6;
export const CHUNK_HEAD_SIZE = 6;
export const CHUNK_MAX = 0xFFFF;

// The recording's bytes, portion by portion, with their times.
class Tape {
    #bytes;
    #at = 0;
    #chunkEnd;
    #timeUs = 0;
    #extra;

    constructor(bytes) {
        this.#bytes = bytes;
        // Version 2 has a marker of two bytes before each head, and a CRC of two after it.
        this.#extra = bytes[VERSION_AT] === 2 ? 2 : 0;
        this.isTimed = MAGIC.every((byte, i) => bytes[i] === byte || (i === VERSION_AT && this.#extra > 0));
        this.rewind();
    }

    get timeMs() {
        return Math.floor(this.#timeUs / 1000);
    }

    rewind() {
        this.#at = this.isTimed ? MAGIC.length : 0;
        this.#chunkEnd = this.isTimed ? this.#at : this.#bytes.length;
        this.#timeUs = 0;
    }

    // At most `size` bytes; none at the end.
    take(size) {
        while (this.#at === this.#chunkEnd && this.#beginChunk()) { /* Chunks may be empty. */ }
        const from = this.#at;
        this.#at = Math.min(from + size, this.#chunkEnd);
        return this.#bytes.subarray(from, this.#at);
    }

    #beginChunk() {
        const bytes = this.#bytes;
        if (!this.isTimed || this.#at + CHUNK_HEAD_SIZE + 2 * this.#extra > bytes.length) {
            return false;
        }
        const head = new DataView(bytes.buffer, bytes.byteOffset + this.#at + this.#extra, CHUNK_HEAD_SIZE);
        this.#timeUs += head.getUint32(0, true);
        this.#at += CHUNK_HEAD_SIZE + 2 * this.#extra;
        this.#chunkEnd = Math.min(this.#at + head.getUint16(4, true), bytes.length);
        return true;
    }
}

export class Recording {
    kind = 'recording';
    #library;
    #tape;
    #isShown;
    #atEnd = false;

    // `isShown`: its scans are the ones that the page shows, as it is played.
    constructor(library, name, bytes, isShown = true) {
        this.#library = library;
        this.#tape = new Tape(bytes);
        this.#isShown = isShown;
        this.name = name;
        const scans = this.#survey();
        this.numbers = library.numbers('recording_numbers');
        this.durationMs = library.call('recording_time_ms');
        this.problem = this.#verdict(scans);
        this.rewind();
    }

    rewind() {
        this.#tape.rewind();
        this.#atEnd = false;
        this.#library.call('recording_rewind', this.#tape.isTimed ? 1 : 0, this.#isShown ? 1 : 0);
    }

    get timeMs() {
        return this.#library.call('recording_time_ms');
    }

    get atEnd() {
        return this.#atEnd;
    }

    // Plays on until `timeMs`; returns how many scans that completed. The last packet may be shorter than
    // a millisecond, so the end is where nothing comes any more.
    playUntil(timeMs) {
        const { NEXT_SCAN, NEXT_END } = this.#library.constants;
        const untilMs = timeMs >= this.durationMs ? Infinity : timeMs;
        let scans = 0;
        while (!this.#atEnd && this.timeMs < untilMs) {
            const next = this.#next();
            this.#atEnd = next === NEXT_END;
            scans += next === NEXT_SCAN ? 1 : 0;
        }
        return scans;
    }

    // To another moment: from the beginning on, which is fast enough.
    seek(timeMs) {
        this.rewind();
        return this.playUntil(timeMs);
    }

    // All samples of all valid packets, as `tmini decode --csv` prints them.
    csv() {
        const { NEXT_END } = this.#library.constants;
        const timeMs = this.timeMs;
        const lines = [CSV_HEADER];
        this.rewind();
        while (this.#next() !== NEXT_END) {
            this.#addRows(lines);
        }
        this.seek(timeMs);
        return `${lines.join('\n')}\n`;
    }

    #addRows(lines) {
        const { count, packet, scan, timeMs, frequencyChz } = this.#library.numbers('recording_packet_numbers');
        const points = this.#library.points('recording_points', count);
        const told = frequencyChz > 0 ? (frequencyChz / 100).toFixed(2) : '';
        for (let i = 0; i < count; i++) {
            lines.push(`${scan},${packet},${points.csv(i)},${timeMs},${told}`);
        }
    }

    // The next packet; feeds what the library asks for.
    #next() {
        const { NEXT_NEEDS_BYTES } = this.#library.constants;
        for (;;) {
            const next = this.#library.call('recording_next');
            if (next !== NEXT_NEEDS_BYTES) {
                return next;
            }
            const part = this.#tape.take(this.#library.transferSize);
            this.#library.hand(part);
            this.#library.call('recording_feed', part.length, this.#tape.timeMs);
        }
    }

    #survey() {
        this.rewind();
        return this.playUntil(Infinity);
    }

    #verdict(scans) {
        const { bytes, packets } = this.numbers;
        if (bytes === 0) {
            return recordingProblems.empty(this.name);
        }
        if (packets === 0) {
            return recordingProblems.none(this.name, bytes);
        }
        return scans === 0 ? recordingProblems.noScan(this.name, packets) : null;
    }
}
