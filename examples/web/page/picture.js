// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The tmini authors

// The picture of the latest scans, seen from above, the front up: rings in metres, points coloured by
// intensity, flagged ones marked, the nearest obstacle of each sector as an arc.

// Ranges to choose from, and how far apart the rings are then.
const SCALES = [[500, 100], [1000, 200], [1500, 500], [2000, 500], [2500, 500], [3000, 1000], [4000, 1000],
                [5000, 1000], [6000, 1000], [8000, 2000], [12000, 2000], [16500, 4000]];
const COLOURS = 16; // Shades of intensity.
const POINT_SIZE = 2.5;

// From little light to much, in equal steps between these; darker on white, brighter on black.
const RAMPS = {
    dark: [[104, 116, 240], [34, 150, 226], [46, 205, 170], [168, 226, 92], [255, 214, 84]],
    light: [[74, 108, 214], [18, 121, 168], [14, 118, 92], [96, 104, 10], [168, 72, 0]],
};

function rampColours(stops) {
    return Array.from({ length: COLOURS }, (_, i) => {
        const place = (i / (COLOURS - 1)) * (stops.length - 1);
        const below = Math.min(Math.floor(place), stops.length - 2);
        const mixed = stops[below].map((from, j) => Math.round(from + (stops[below + 1][j] - from) * (place - below)));
        return `rgb(${mixed.join(' ')})`;
    });
}

function scaleFor(farthestMm) {
    return SCALES.find(([range]) => range >= farthestMm);
}

export class Picture {
    persistence = 3;
    rangeMm = 0; // Chosen by hand; 0: as far as there is something.
    #canvas;
    #context;
    #constants;
    #scans = []; // The newest first.
    #numbers = null;
    #sectors = [];
    #autoMm = SCALES[0][0];
    #sines;
    #theme = {};
    #isDue = false;

    constructor(canvas, constants) {
        const circle = constants.FULL_CIRCLE_Q6;
        this.#canvas = canvas;
        this.#context = canvas.getContext('2d', { alpha: false });
        this.#constants = constants;
        // A quarter more than the circle: the cosine is the sine of an angle ahead.
        this.#sines = Float32Array.from({ length: circle + circle / 4 },
                                        (_, i) => Math.sin((i / circle) * 2 * Math.PI));
        this.#readTheme();
        new ResizeObserver(() => this.draw()).observe(canvas);
        matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => {
            this.#readTheme();
            this.draw();
        });
    }

    // One more scan: its points, its numbers, the nearest distance in each sector.
    add(points, numbers, sectors) {
        this.#scans.unshift(points);
        this.#scans.length = Math.min(this.#scans.length, this.persistence);
        this.#show(numbers, sectors);
    }

    // The latest scan has changed: other ones no longer fit to it.
    replace(points, numbers, sectors) {
        this.#scans = numbers.points > 0 ? [points] : [];
        this.#show(numbers, sectors);
    }

    clear() {
        this.#scans = [];
        this.#numbers = null;
        this.#sectors = [];
        this.#autoMm = SCALES[0][0];
        this.draw();
    }

    // Once before the screen is painted next, however often it is asked for.
    draw() {
        if (this.#isDue) {
            return;
        }
        this.#isDue = true;
        requestAnimationFrame(() => {
            this.#isDue = false;
            this.#paint();
        });
    }

    // As a PNG.
    blob() {
        this.#paint();
        return new Promise((resolve) => this.#canvas.toBlob(resolve, 'image/png'));
    }

    #show(numbers, sectors) {
        this.#numbers = numbers;
        this.#sectors = sectors;
        this.#autoMm = Math.max(this.#autoMm, scaleFor(numbers.farthestMm)[0]);
        this.draw();
    }

    #readTheme() {
        const style = getComputedStyle(document.documentElement);
        const colour = (name) => style.getPropertyValue(`--${name}`).trim();
        for (const name of ['ground', 'grid', 'text', 'dim', 'accent', 'alarm']) {
            this.#theme[name] = colour(name);
        }
        this.#theme.font = style.fontFamily;
        this.#theme.ramp = rampColours(matchMedia('(prefers-color-scheme: dark)').matches ? RAMPS.dark : RAMPS.light);
    }

    get #shownMm() {
        return this.rangeMm || this.#autoMm;
    }

    #paint() {
        const frame = this.#fit();
        const context = this.#context;
        context.fillStyle = this.#theme.ground;
        context.fillRect(0, 0, frame.width, frame.height);
        this.#paintGrid(frame);
        for (let age = this.#scans.length - 1; age >= 0; age--) {
            context.globalAlpha = age === 0 ? 1 : 0.55 * (1 - age / this.#scans.length);
            this.#paintPoints(frame, this.#scans[age]);
        }
        context.globalAlpha = 1;
        this.#paintSectors(frame);
        this.#paintNearest(frame);
        this.#paintLidar(frame);
        this.#paintLegend(frame);
    }

    // As many pixels as the screen has, in the units of CSS.
    #fit() {
        const ratio = devicePixelRatio;
        const { clientWidth: width, clientHeight: height } = this.#canvas;
        const [columns, rows] = [Math.round(width * ratio), Math.round(height * ratio)];
        if (this.#canvas.width !== columns || this.#canvas.height !== rows) {
            this.#canvas.width = columns;
            this.#canvas.height = rows;
        }
        this.#context.setTransform(ratio, 0, 0, ratio, 0, 0);
        const radius = Math.max(Math.min(width, height) / 2 - 22, 10);
        return { width, height, x: width / 2, y: height / 2, radius, scale: radius / this.#shownMm };
    }

    #paintGrid({ x, y, radius, scale }) {
        const context = this.#context;
        const rangeMm = this.#shownMm;
        const [, step] = scaleFor(rangeMm);
        context.strokeStyle = this.#theme.grid;
        context.lineWidth = 1;
        context.beginPath();
        for (let mm = step; mm <= rangeMm; mm += step) {
            context.moveTo(x + mm * scale, y);
            context.arc(x, y, mm * scale, 0, 2 * Math.PI);
        }
        for (let eighth = 0; eighth < 8; eighth++) {
            const [sine, cosine] = [Math.sin((eighth * Math.PI) / 4), Math.cos((eighth * Math.PI) / 4)];
            context.moveTo(x + 14 * sine, y - 14 * cosine);
            context.lineTo(x + radius * sine, y - radius * cosine);
        }
        context.stroke();
        context.fillStyle = this.#theme.dim;
        context.font = `12px ${this.#theme.font}`;
        context.textAlign = 'left';
        const labelled = step * scale >= 28 ? step : 2 * step; // With room between them.
        for (let mm = labelled; mm <= rangeMm; mm += labelled) {
            context.fillText(`${mm / 1000} m`, x + 4, y + mm * scale - 4);
        }
        context.textAlign = 'center';
        context.fillText('front', x, y - radius - 8);
    }

    #paintPoints({ x, y, scale }, points) {
        const context = this.#context;
        const { FULL_CIRCLE_Q6: circle, FLAG_SPECULAR } = this.#constants;
        const { darkest, brightest } = this.#numbers;
        const shade = (COLOURS - 1) / Math.max(brightest - darkest, 1);
        const limit = this.#shownMm;
        let last = -1;
        for (let i = 0; i < points.count; i++) {
            const distance = points.distanceMm(i);
            if (distance === 0 || distance > limit) {
                continue;
            }
            const angle = points.angleQ6(i);
            const px = x + distance * scale * this.#sines[angle];
            const py = y - distance * scale * this.#sines[angle + circle / 4];
            const colour = Math.min(Math.max(Math.round((points.intensity(i) - darkest) * shade), 0), COLOURS - 1);
            if (colour !== last) {
                context.fillStyle = this.#theme.ramp[colour];
                last = colour;
            }
            context.fillRect(px - POINT_SIZE / 2, py - POINT_SIZE / 2, POINT_SIZE, POINT_SIZE);
            if (points.flag(i) >= FLAG_SPECULAR) {
                this.#paintFlag(px, py, points.flag(i) === FLAG_SPECULAR);
            }
        }
    }

    // A cross for a specular reflection, a plus for ambient light: told apart without colour.
    #paintFlag(x, y, isSpecular) {
        const context = this.#context;
        context.strokeStyle = this.#theme.alarm;
        context.lineWidth = 1.25;
        context.beginPath();
        for (const [dx, dy] of isSpecular ? [[3, 3], [3, -3]] : [[4, 0], [0, 4]]) {
            context.moveTo(x - dx, y - dy);
            context.lineTo(x + dx, y + dy);
        }
        context.stroke();
    }

    #paintSectors({ x, y, scale }) {
        const context = this.#context;
        const width = (2 * Math.PI) / this.#sectors.length;
        this.#sectors.forEach((mm, i) => {
            if (mm === 0 || mm > this.#shownMm) {
                return;
            }
            const middle = i * width - Math.PI / 2;
            context.strokeStyle = i === this.#numbers.nearestSector ? this.#theme.accent : this.#theme.dim;
            context.lineWidth = i === this.#numbers.nearestSector ? 2 : 1;
            context.beginPath();
            context.arc(x, y, mm * scale, middle - width * 0.46, middle + width * 0.46);
            context.stroke();
        });
    }

    #paintNearest({ width, x, y, scale }) {
        const context = this.#context;
        const { nearestMm, nearestQ6 } = this.#numbers ?? {};
        if (!nearestMm || nearestMm > this.#shownMm) {
            return;
        }
        const px = x + nearestMm * scale * this.#sines[nearestQ6];
        const py = y - nearestMm * scale * this.#sines[nearestQ6 + this.#constants.FULL_CIRCLE_Q6 / 4];
        context.strokeStyle = this.#theme.accent;
        context.lineWidth = 2;
        context.strokeRect(px - 5, py - 5, 10, 10);
        context.fillStyle = this.#theme.accent;
        context.font = `600 13px ${this.#theme.font}`;
        const isRight = px > x && px + 80 < width; // Outwards, if there is room.
        context.textAlign = isRight ? 'left' : 'right';
        const place = [`${(nearestMm / 1000).toFixed(3)} m`, px + (isRight ? 9 : -9), py + 4];
        context.strokeStyle = this.#theme.ground;
        context.lineWidth = 4;
        context.strokeText(...place);
        context.fillText(...place);
    }

    // A triangle that points to the front.
    #paintLidar({ x, y }) {
        const context = this.#context;
        context.fillStyle = this.#theme.text;
        context.beginPath();
        context.moveTo(x, y - 8);
        context.lineTo(x + 6, y + 6);
        context.lineTo(x - 6, y + 6);
        context.fill();
    }

    #paintLegend({ height }) {
        const context = this.#context;
        const numbers = this.#numbers;
        if (!numbers || numbers.valid === 0) {
            return;
        }
        this.#theme.ramp.forEach((colour, i) => {
            context.fillStyle = colour;
            context.fillRect(12 + 5 * i, height - 18, 5, 8);
        });
        context.fillStyle = this.#theme.dim;
        context.font = `12px ${this.#theme.font}`;
        context.textAlign = 'left';
        context.fillText(`intensity ${numbers.darkest} to ${numbers.brightest}`, 12, height - 24);
        if (numbers.flagged > 0) {
            context.fillText(`× + flagged: ${numbers.flagged}`, 12, height - 42);
        }
    }
}
