// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The tmini authors

// Plays a recording, and handles its controls.

import { element, log, setText } from './panels.js';

const PLAY_MS = 20;

export class Player {
    #recording;
    #listener;
    #timer = 0;
    #isPlaying = false;

    // Begins to play. Calls these functions of `listener`: onScan(), and onJump() when another moment is shown.
    constructor(recording, listener) {
        this.#recording = recording;
        this.#listener = listener;
        element('position').max = recording.durationMs;
        this.toggle();
    }

    get recording() {
        return this.#recording;
    }

    // Pauses, or plays on. After the end it plays from the beginning.
    toggle() {
        if (this.#isPlaying) {
            this.pause();
            return;
        }
        if (this.#recording.atEnd) {
            this.#recording.rewind();
        }
        const begun = performance.now() - this.#recording.timeMs;
        this.#timer = setInterval(() => this.#playUntil(performance.now() - begun), PLAY_MS);
        this.#isPlaying = true;
        setText('play', 'Pause');
    }

    pause() {
        clearInterval(this.#timer);
        this.#isPlaying = false;
        setText('play', 'Play');
    }

    seek(timeMs) {
        this.pause();
        this.#recording.seek(timeMs);
        this.#listener.onJump();
        this.#showPosition();
    }

    #playUntil(timeMs) {
        if (this.#recording.playUntil(timeMs) > 0) {
            this.#listener.onScan();
        }
        if (this.#recording.atEnd) {
            this.pause();
            log('end of the recording');
        }
        this.#showPosition();
    }

    #showPosition() {
        const seconds = (ms) => (ms / 1000).toFixed(1);
        const { timeMs, durationMs } = this.#recording;
        element('position').value = timeMs;
        setText('time', `${seconds(timeMs)} of ${seconds(durationMs)} s`);
    }
}
