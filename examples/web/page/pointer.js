// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The tmini authors

// Mouse, pen or fingers on the picture: shows what is under them, moves and enlarges the picture.

import { degrees, setText } from './panels.js';

const WHEEL_STEP = 0.002; // The change of the zoom's logarithm per pixel of the wheel.

export class Pointer {
    #canvas;
    #picture;
    #held = new Map(); // Pressed pointers: [x, y] by identifier.

    constructor(canvas, picture) {
        this.#canvas = canvas;
        this.#picture = picture;
        canvas.addEventListener('pointerdown', (event) => {
            canvas.setPointerCapture(event.pointerId);
            this.#held.set(event.pointerId, [event.offsetX, event.offsetY]);
        });
        canvas.addEventListener('pointermove', (event) => this.#move(event));
        for (const end of ['pointerup', 'pointercancel']) {
            canvas.addEventListener(end, (event) => this.#held.delete(event.pointerId));
        }
        canvas.addEventListener('pointerleave', () => setText('pointer', ''));
        canvas.addEventListener('dblclick', () => picture.enlarge(0));
        canvas.addEventListener('wheel', (event) => {
            event.preventDefault();
            picture.enlarge(Math.exp(-event.deltaY * WHEEL_STEP), event.offsetX, event.offsetY);
        }, { passive: false });
    }

    #move(event) {
        const { offsetX: x, offsetY: y, pointerId } = event;
        const place = this.#picture.at(x, y);
        setText('pointer', `${place.metres.toFixed(3)} m at ${degrees(place.degrees * 64)}°`);
        const before = this.#held.get(pointerId);
        if (before === undefined) {
            return;
        }
        const other = [...this.#held].find(([id]) => id !== pointerId)?.[1];
        if (other === undefined) {
            this.#picture.move(x - before[0], y - before[1]);
        } else { // Two fingers: enlarges as their distance grows.
            const apart = Math.max(Math.hypot(before[0] - other[0], before[1] - other[1]), 1);
            this.#picture.enlarge(Math.hypot(x - other[0], y - other[1]) / apart, ...other);
        }
        this.#held.set(pointerId, [x, y]);
    }
}
