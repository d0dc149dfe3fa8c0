// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The tmini authors

// The picture of the latest scans, seen from above, with the front up: rings in metres, points coloured by
// intensity, flagged ones marked, the nearest obstacle of each sector as an arc. The user can enlarge and move it.

import { degrees, metres } from './panels.js';

// The possible ranges, and the distance between rings for each.
const SCALES = [[500, 100], [1000, 200], [1500, 500], [2000, 500], [2500, 500], [3000, 1000], [4000, 1000],
                [5000, 1000], [6000, 1000], [8000, 2000], [12000, 2000], [16500, 4000]];
const COLOURS = 16; // Shades of intensity.
const ZOOM_MAX = 40;
const EMPTY_MM = 6000; // The range without points.
const MARGIN = 44; // Around the outermost ring, for the angles.
const LEGEND_ROW = 24;
const LEGEND_ROWS = [[560, 3], [860, 2], [Infinity, 1]]; // The legend's rows on a canvas below this width.
const BEAM_CORE = 0.2; // A part of the radius: there the beams are close together.

// Colours from low to high intensity, in equal steps: those of the tool's pictures, and darker ones on white.
const RAMPS = {
    dark: [[82, 92, 227], [33, 150, 227], [46, 204, 171], [168, 227, 92], [255, 214, 84]],
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
    rangeMm = 0; // Chosen by the user; 0: as far as the points.
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
    #isStale = false;
    #zoom = 1;
    #shift = [0, 0]; // The lidar's distance from the middle, in pixels.

    constructor(canvas, constants) {
        const circle = constants.FULL_CIRCLE_Q6;
        this.#canvas = canvas;
        this.#context = canvas.getContext('2d', { alpha: false });
        this.#constants = constants;
        // A circle and a quarter, because the cosine is the sine a quarter later.
        this.#sines = Float32Array.from({ length: circle + circle / 4 },
                                        (_, i) => Math.sin((i / circle) * 2 * Math.PI));
        this.#readTheme();
        new ResizeObserver(() => this.draw()).observe(canvas);
    }

    retheme() {
        this.#readTheme();
        this.draw();
    }

    // An outdated picture is grey.
    set isStale(isStale) {
        if (this.#isStale !== isStale) {
            this.#isStale = isStale;
            this.draw();
        }
    }

    // Enlarges by a factor, also below 1; the picture's place (x, y) does not move.
    enlarge(factor, x = this.#canvas.clientWidth / 2, y = this.#canvas.clientHeight / 2) {
        const zoom = Math.min(Math.max(this.#zoom * factor, 1), ZOOM_MAX);
        const frame = this.#frame();
        const middle = [x - frame.x + this.#shift[0], y - frame.y + this.#shift[1]];
        const change = zoom / this.#zoom;
        this.#zoom = zoom;
        this.#canvas.style.touchAction = zoom > 1 ? 'none' : ''; // Otherwise a finger scrolls the page.
        this.#shift = zoom === 1 ? [0, 0] : this.#shift.map((shift, i) => middle[i] + (shift - middle[i]) * change);
        this.draw();
    }

    // Moves the picture by some pixels, if it is enlarged.
    move(dx, dy) {
        if (this.#zoom > 1) {
            this.#shift = [this.#shift[0] + dx, this.#shift[1] + dy];
            this.draw();
        }
    }

    // What is at this pixel: distance in metres, and angle in degrees clockwise from the front.
    at(px, py) {
        const { x, y, scale } = this.#frame();
        const degrees = (Math.atan2(px - x, y - py) / Math.PI) * 180;
        return { metres: Math.hypot(px - x, y - py) / scale / 1000, degrees: (degrees + 360) % 360 };
    }

    // Adds a scan: its points, its numbers, the nearest distance in each sector.
    add(points, numbers, sectors) {
        this.#scans.unshift(points);
        this.#scans.length = Math.min(this.#scans.length, this.persistence);
        this.#show(numbers, sectors);
    }

    // The latest scan has changed: older ones do not match it, and are dropped.
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

    // Draws once before the screen is painted next, however often this is called.
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

    // The picture as a PNG.
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
        const names = ['ground', 'page', 'grid', 'edge', 'text', 'dim', 'nearest', 'specular', 'ambient', 'beam',
                       'beam-core'];
        for (const name of names) {
            this.#theme[name] = colour(name);
        }
        this.#theme.font = style.fontFamily;
        this.#theme.ramp = rampColours(style.colorScheme === 'light' ? RAMPS.light : RAMPS.dark);
    }

    get #shownMm() {
        return this.rangeMm || (this.#numbers ? this.#autoMm : EMPTY_MM);
    }

    // If a unit flags most of its points, flags are not marked.
    get #marksFlags() {
        return 2 * this.#numbers.flagged <= this.#numbers.valid;
    }

    #paint() {
        const frame = this.#fit();
        const context = this.#context;
        context.fillStyle = this.#theme.page;
        context.fillRect(0, 0, frame.width, frame.height);
        this.#paintDisc(frame);
        this.#paintBeams(frame);
        this.#paintGrid(frame);
        this.#paintAngles(frame);
        for (let age = this.#scans.length - 1; age >= 0; age--) {
            context.globalAlpha = age === 0 ? 1 : 0.55 * (1 - age / this.#scans.length);
            this.#paintPoints(frame, this.#scans[age]);
        }
        context.globalAlpha = 1;
        if (!this.#isStale && this.#numbers?.points > 0) {
            this.#paintMarks(frame);
            this.#paintSectors(frame);
            this.#paintNearest(frame);
            this.#paintLegend(frame);
        }
        this.#paintLidar(frame);
    }

    // Gives the canvas the screen's resolution, but draws in CSS pixels.
    #fit() {
        const ratio = devicePixelRatio;
        const frame = this.#frame();
        const [columns, rows] = [Math.round(frame.width * ratio), Math.round(frame.height * ratio)];
        if (this.#canvas.width !== columns || this.#canvas.height !== rows) {
            this.#canvas.width = columns;
            this.#canvas.height = rows;
        }
        this.#context.setTransform(ratio, 0, 0, ratio, 0, 0);
        return frame;
    }

    // The lidar's place, and the scale in pixels per millimetre. `size`: a point's size, which grows with the picture;
    // `mark`: a mark's size.
    #frame() {
        const { clientWidth: width, clientHeight: height } = this.#canvas;
        const legend = LEGEND_ROW * LEGEND_ROWS.find(([limit]) => width < limit)[1] + 8;
        const whole = Math.max(Math.min(width, height - legend) / 2 - MARGIN, 10);
        const radius = whole * this.#zoom;
        return { width, height, legend, x: width / 2 + this.#shift[0], y: (height - legend) / 2 + this.#shift[1],
                 radius, scale: radius / this.#shownMm, size: Math.max(whole * 0.0068, 1) * Math.sqrt(this.#zoom),
                 mark: Math.max(whole * 0.0148, 3.5) };
    }

    // The place at an angle clockwise from the front, in 1/64 degree, and a distance in pixels.
    #place({ x, y }, angleQ6, distance) {
        const angle = angleQ6 % this.#constants.FULL_CIRCLE_Q6;
        return [x + distance * this.#sines[angle],
                y - distance * this.#sines[angle + this.#constants.FULL_CIRCLE_Q6 / 4]];
    }

    #paintDisc({ x, y, radius }) {
        const context = this.#context;
        context.beginPath();
        context.arc(x, y, radius, 0, 2 * Math.PI);
        context.fillStyle = this.#theme.ground;
        context.fill();
        context.strokeStyle = this.#theme.edge;
        context.lineWidth = 1.5;
        context.stroke();
    }

    // The free space: a beam to each point, as wide as the distance between points.
    #paintBeams(frame) {
        const points = this.#isStale ? undefined : this.#scans[0];
        if (points === undefined || points.count === 0) {
            return;
        }
        const context = this.#context;
        const half = Math.ceil(this.#constants.FULL_CIRCLE_Q6 / points.count / 2);
        context.beginPath();
        for (let i = 0; i < points.count; i++) {
            const distance = Math.min(points.distanceMm(i), this.#shownMm) * frame.scale;
            const angle = points.angleQ6(i) + this.#constants.FULL_CIRCLE_Q6;
            if (distance > 0) {
                context.moveTo(frame.x, frame.y);
                context.lineTo(...this.#place(frame, angle - half, distance));
                context.lineTo(...this.#place(frame, angle + half, distance));
            }
        }
        const light = context.createRadialGradient(frame.x, frame.y, 0, frame.x, frame.y, frame.radius);
        light.addColorStop(0, this.#theme['beam-core']);
        light.addColorStop(BEAM_CORE, this.#theme.beam);
        light.addColorStop(1, this.#theme.beam);
        context.fillStyle = light;
        context.fill();
    }

    #paintGrid({ x, y, scale }) {
        const context = this.#context;
        const rangeMm = this.#shownMm;
        const [, step] = scaleFor(rangeMm / this.#zoom);
        context.strokeStyle = this.#theme.grid;
        context.lineWidth = 1;
        context.beginPath();
        for (let mm = step; mm < rangeMm; mm += step) {
            context.moveTo(x + mm * scale, y);
            context.arc(x, y, mm * scale, 0, 2 * Math.PI);
        }
        context.stroke();
        context.fillStyle = this.#theme.dim;
        context.font = `12px ${this.#theme.font}`;
        context.textAlign = 'center';
        const labelled = step * scale >= 28 ? step : 2 * step; // So that labels do not overlap.
        for (let mm = labelled; mm <= rangeMm; mm += labelled) {
            const [tx, ty] = this.#place({ x, y }, 15 * 64, mm * scale - 10);
            context.fillText(`${mm / 1000} m`, tx, ty + 4);
        }
    }

    #paintAngles(frame) {
        const context = this.#context;
        const sides = { 0: 'front', 90: 'right', 180: 'back', 270: 'left' };
        context.textAlign = 'center';
        context.lineWidth = 1;
        context.strokeStyle = this.#theme.grid;
        context.beginPath();
        for (let degrees = 0; degrees < 360; degrees += 30) {
            context.moveTo(...this.#place(frame, degrees * 64, 20));
            context.lineTo(...this.#place(frame, degrees * 64, frame.radius));
            const [x, y] = this.#place(frame, degrees * 64, frame.radius + 24);
            context.fillStyle = this.#theme.text;
            context.fillText(`${degrees}°`, x, sides[degrees] ? y - 2 : y + 4);
            context.fillStyle = this.#theme.dim;
            context.fillText(sides[degrees] ?? '', x, y + 12);
        }
        context.stroke();
        context.strokeStyle = this.#theme.edge;
        context.beginPath();
        for (let degrees = 0; degrees < 360; degrees += 5) {
            context.moveTo(...this.#place(frame, degrees * 64, frame.radius));
            context.lineTo(...this.#place(frame, degrees * 64, frame.radius + (degrees % 10 === 0 ? 7 : 4)));
        }
        context.stroke();
    }

    #paintPoints(frame, points) {
        const context = this.#context;
        const { darkest, brightest } = this.#numbers;
        const shade = (COLOURS - 1) / Math.max(brightest - darkest, 1);
        const shades = Array.from({ length: COLOURS }, () => []);
        for (let i = 0; i < points.count; i++) {
            const distance = points.distanceMm(i);
            if (distance === 0 || distance > this.#shownMm) {
                continue;
            }
            const place = this.#place(frame, points.angleQ6(i), distance * frame.scale);
            const colour = Math.min(Math.max(Math.round((points.intensity(i) - darkest) * shade), 0), COLOURS - 1);
            shades[colour].push(place);
        }
        shades.forEach((places, colour) => {
            context.fillStyle = this.#isStale ? this.#theme.dim : this.#theme.ramp[colour];
            context.beginPath();
            for (const [x, y] of places) {
                context.moveTo(x + frame.size, y);
                context.arc(x, y, frame.size, 0, 2 * Math.PI);
            }
            context.fill();
        });
    }

    #paintMarks(frame) {
        const [points] = this.#scans;
        for (let i = 0; i < points.count && this.#marksFlags; i++) {
            const distance = points.distanceMm(i);
            if (distance > 0 && distance <= this.#shownMm && points.flag(i) >= this.#constants.FLAG_SPECULAR) {
                this.#paintFlag(...this.#place(frame, points.angleQ6(i), distance * frame.scale), frame.mark,
                                points.flag(i) === this.#constants.FLAG_SPECULAR);
            }
        }
    }

    // A ring for a specular reflection, a cross for ambient light: they differ even without colour.
    #paintFlag(x, y, size, isSpecular) {
        const context = this.#context;
        context.strokeStyle = isSpecular ? this.#theme.specular : this.#theme.ambient;
        context.lineWidth = 1.5;
        context.beginPath();
        if (isSpecular) {
            context.arc(x, y, size, 0, 2 * Math.PI);
        } else {
            const arm = 0.8 * size;
            context.moveTo(x - arm, y - arm);
            context.lineTo(x + arm, y + arm);
            context.moveTo(x + arm, y - arm);
            context.lineTo(x - arm, y + arm);
        }
        context.stroke();
    }

    #paintSectors({ x, y, scale }) {
        const context = this.#context;
        const width = (2 * Math.PI) / this.#sectors.length;
        this.#sectors.forEach((mm, i) => {
            if (mm > this.#shownMm) {
                return;
            }
            const middle = i * width - Math.PI / 2;
            const isNearest = i === this.#numbers.nearestSector;
            context.strokeStyle = isNearest ? this.#theme.nearest : this.#theme.dim;
            context.lineWidth = isNearest ? 2 : 1;
            context.beginPath();
            context.arc(x, y, mm * scale, middle - width * 0.46, middle + width * 0.46);
            context.stroke();
        });
    }

    #paintNearest(frame) {
        const { nearestMm, nearestQ6 } = this.#numbers;
        if (nearestMm > 0 && nearestMm <= this.#shownMm) {
            this.#paintRing(...this.#place(frame, nearestQ6, nearestMm * frame.scale), 1.7 * frame.mark);
        }
    }

    #paintRing(x, y, radius) {
        const context = this.#context;
        context.strokeStyle = this.#theme.nearest;
        context.lineWidth = 2;
        context.beginPath();
        context.arc(x, y, radius, 0, 2 * Math.PI);
        context.stroke();
    }

    // An arrow that points to the front.
    #paintLidar({ x, y }) {
        const context = this.#context;
        context.fillStyle = this.#theme.page;
        context.strokeStyle = this.#theme.text;
        context.lineWidth = 1.5;
        context.beginPath();
        context.arc(x, y, 8, 0, 2 * Math.PI);
        context.fill();
        context.moveTo(x, y - 8);
        context.lineTo(x, y - 23);
        context.moveTo(x - 4, y - 17);
        context.lineTo(x, y - 23);
        context.lineTo(x + 4, y - 17);
        context.stroke();
        context.fillStyle = this.#theme.text;
        context.beginPath();
        context.arc(x, y, 2.5, 0, 2 * Math.PI);
        context.fill();
    }

    // The meaning of the signs: [width of the sign, function that draws it at (x, y), text].
    #legend() {
        const { darkest, brightest, flagged, valid, specular, ambient, nearestMm, nearestQ6 } = this.#numbers;
        const context = this.#context;
        const ramp = (x, y) => this.#theme.ramp.forEach((colour, i) => {
            context.fillStyle = colour;
            context.fillRect(x + 4 * i, y - 4, 4, 8);
        });
        const arc = (x, y) => {
            context.strokeStyle = this.#theme.dim;
            context.lineWidth = 1;
            context.beginPath();
            context.arc(x + 8, y + 10, 14, -0.7 * Math.PI, -0.3 * Math.PI);
            context.stroke();
        };
        const flags = this.#marksFlags
            ? [[12, (x, y) => this.#paintFlag(x + 6, y, 5, true), `specular (${specular})`],
               [12, (x, y) => this.#paintFlag(x + 6, y, 5, false), `ambient light (${ambient})`]]
            : [[0, () => {}, `${flagged} of ${valid} points flagged: not marked`]];
        return [
            [4 * COLOURS, ramp, `intensity ${darkest} to ${brightest}`],
            ...flags,
            [16, arc, 'nearest in its eighth'],
            [16, (x, y) => this.#paintRing(x + 8, y, 7), `nearest ${metres(nearestMm)} at ${degrees(nearestQ6)}°`],
        ];
    }

    // Paints the legend row by row, with as many entries as each has room for.
    #paintLegend({ width, height, legend }) {
        const context = this.#context;
        if (this.#numbers.valid === 0) {
            return;
        }
        context.fillStyle = this.#theme.page;
        context.fillRect(0, height - legend, width, legend);
        context.font = `12px ${this.#theme.font}`;
        context.textAlign = 'left';
        const rows = [{ items: [], width: 0 }];
        for (const [sign, paint, words] of this.#legend()) {
            const item = { sign, paint, words, width: sign + 6 + context.measureText(words).width };
            const room = width - 24 - rows.at(-1).width - 20 * rows.at(-1).items.length;
            if (room < item.width) {
                rows.push({ items: [], width: 0 });
            }
            rows.at(-1).items.push(item);
            rows.at(-1).width += item.width;
        }
        rows.forEach((row, i) => {
            const gap = row.items.length > 1 && rows.length === 1
                ? Math.min((width - 24 - row.width) / (row.items.length - 1), 44) : 20;
            let x = (width - row.width - gap * (row.items.length - 1)) / 2;
            const y = height - legend / 2 + LEGEND_ROW * (i - (rows.length - 1) / 2);
            for (const { sign, paint, words, width: wide } of row.items) {
                paint(x, y);
                context.fillStyle = this.#theme.dim;
                context.fillText(words, x + sign + 6, y + 4);
                x += wide + gap;
            }
        });
    }
}
