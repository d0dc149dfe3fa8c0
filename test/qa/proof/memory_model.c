/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* memory_model [--long]
 *
 * Explores the library's own ring exhaustively, as two cores may see it: every interleaving, and
 * every value that a load may return with C11's release and acquire; first with all barriers, then
 * with one at a time weakened to relaxed. Exit status 0 if the ring holds with all barriers, and
 * each weakened barrier has the effect given in the table at the end: the ring breaks, or holds (if
 * this barrier is not needed).
 *
 * The ring's accesses come here (proof_atomic.h). A step of a thread runs its operation from the
 * beginning: accesses that it has made before return what they returned then, the next one is
 * made, and the one after that ends the step.
 *
 * The model: each place has only one writer, and a list of the values stored to it. A thread's view
 * is how far it has come in each list. A load returns any value from there on. An acquire load also
 * takes over the view that the release store had. The model does not let a later relaxed store by
 * the same thread release, too: C11 does, but no longer C++20. If the CPU feeds the ring, its bytes
 * are plain memory: whoever uses one must have seen the other side's last use of it, otherwise it
 * is a race. DMA writes the bytes without the CPU: a load of a byte returns any value that the view
 * permits, and the hardware writes in the order of time, after whatever was published before.
 *
 * The model checks: there is no race; bytes come in order; if and only if bytes are missing, the
 * ring was found closed there; when it is found closed, the bytes refused before are counted; with
 * DMA, a byte that was read and then found intact is the right byte.
 *
 * States already explored are stored as hashes of 64 bits. */

#include "tmini/parts/tmini_ring.h"

#include <inttypes.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CELLS 4u
#define STORES_MAX 12u  /* To one place. */
#define ACCESSES_MAX 8u /* Of one operation. */

/* The places in memory; the last ones are when the CPU has read each byte. */
enum { HEAD, TAIL, OVERRUN, BYTE, READ = BYTE + CELLS, PLACES = READ + CELLS, FENCE };
enum { PRODUCER, CONSUMER, THREADS };

/* The operations of producer and consumer, with a ring that the CPU feeds and one of DMA. */
typedef enum { PUT, GAP, TAKE, WRITE, PUBLISH, TAKE_FROM_DMA, NOTHING } operation_t;
enum { OPERATIONS = 3 };

typedef struct {
    uint8_t at[PLACES];
} view_t;

typedef struct {
    uint16_t value;
    bool releases;
    view_t view; /* The writer's. */
} store_t;

/* What a thread has when no operation is under way. */
typedef struct {
    tmini_ring_t ring; /* Only the members that it writes count. */
    uint8_t turns;     /* Bytes put or lost, or looks for bytes. */
    uint8_t last;      /* The last byte taken. */
    bool found_closed;
} work_t;

typedef struct {
    work_t work; /* Before the operation under way. */
    uint8_t operation;
    uint8_t made;                  /* Accesses of that operation. */
    uint16_t values[ACCESSES_MAX]; /* What these returned. */
    view_t view;
    view_t fenced; /* The view that it would have after a fence. */
} thread_t;

typedef struct {
    thread_t threads[THREADS];
    uint8_t newest[PLACES]; /* The number of the last store. */
    store_t stores[PLACES][STORES_MAX];
} state_t;

/* An access that has an order: a load or store of this place by this operation, and whether the
 * store closes or opens the ring. */
typedef struct {
    operation_t operation;
    unsigned place;
    bool closes;
} access_t;

typedef struct {
    operation_t first; /* Of the three operations. */
    unsigned size;
    unsigned turns[THREADS];
} bounds_t;

static bounds_t bounds;
static access_t weakened;
static const char *wrong;

static bool is_dma(void)
{
    return bounds.first == WRITE;
}

/* ---- States already explored ---- */

static uint64_t states;
static uint64_t *seen_hashes;
static size_t hashes; /* Room for these: a power of two, twice the number of states. */

static void give_up(bool is_so, const char *why)
{
    if (is_so) {
        (void)fprintf(stderr, "memory_model: %s\n", why);
        exit(2);
    }
}

static uint64_t hash_of(const state_t *state)
{
    const uint8_t *const bytes = (const uint8_t *)state;
    uint64_t hash = 0x9E3779B97F4A7C15u;
    for (size_t i = 0; i + 8 <= sizeof *state; i += 8) {
        uint64_t word;
        memcpy(&word, &bytes[i], 8);
        hash = (hash ^ word) * 0xD6E8FEB86659FD93u;
        hash ^= hash >> 32;
    }
    return hash | 1;
}

static bool is_new_state(const state_t *state)
{
    const uint64_t hash = hash_of(state);
    size_t at = (size_t)(hash * 0xD6E8FEB86659FD93u >> 20) & (hashes - 1);
    while (seen_hashes[at] != 0 && seen_hashes[at] != hash) {
        at = (at + 1) & (hashes - 1);
    }
    if (seen_hashes[at] == hash) {
        return false;
    }
    give_up(2 * ++states > hashes, "too many states");
    seen_hashes[at] = hash;
    return true;
}

/* ---- The step under way ---- */

static state_t *state;
static thread_t *thread;
static work_t work;           /* The thread's, changed by its operation. */
static uint8_t memory[CELLS]; /* The ring's, as the operation writes it. */
static unsigned accesses;     /* Of the operation, in this step. */
static unsigned choice;       /* Which of the possible values the new access returns. */
static jmp_buf stopped;

enum { RUNS, PAUSES, HAS_NO_CHOICE };

/* Ends the step if it has made its access. True: this access is the new one. */
static bool is_new_access(unsigned choices)
{
    if (accesses > thread->made) {
        longjmp(stopped, PAUSES);
    }
    give_up(accesses == ACCESSES_MAX, "too many accesses");
    if (accesses++ < thread->made) {
        return false;
    }
    if (choice >= choices) {
        longjmp(stopped, HAS_NO_CHOICE);
    }
    return true;
}

/* What the last access returned, now or when it was made. */
static uint16_t *result(void)
{
    return &thread->values[accesses - 1];
}

static void see(view_t *view, const view_t *other)
{
    for (unsigned place = 0; place < PLACES; place++) {
        view->at[place] = view->at[place] > other->at[place] ? view->at[place] : other->at[place];
    }
}

static bool is_weak(unsigned place, bool closes)
{
    return weakened.operation == (operation_t)thread->operation && weakened.place == place &&
           weakened.closes == closes;
}

/* Only the place's writer calls this: it has seen all earlier values. */
static void add(unsigned place, uint16_t value, bool releases)
{
    const uint8_t at = ++state->newest[place];
    give_up(at == STORES_MAX, "too many stores");
    thread->view.at[place] = at;
    state->stores[place][at] = (store_t){value, releases, thread->view};
}

static void must_have_seen(unsigned place, const char *otherwise)
{
    if (thread->view.at[place] != state->newest[place]) {
        wrong = otherwise;
    }
}

static uint8_t newest_byte(unsigned at)
{
    return (uint8_t)state->stores[BYTE + at][state->newest[BYTE + at]].value;
}

/* Plain writes of the producer since the last access. All bytes put are different. */
static void note_writes(void)
{
    for (unsigned at = 0; at < CELLS && !is_dma(); at++) {
        if (memory[at] != newest_byte(at)) {
            must_have_seen(READ + at, "a race: a byte is overwritten while it is read");
            add(BYTE + at, memory[at], false);
        }
    }
}

static uint16_t load(unsigned place)
{
    if (is_new_access(state->newest[place] - thread->view.at[place] + 1u)) {
        note_writes();
        thread->view.at[place] = (uint8_t)(thread->view.at[place] + choice);
        const store_t *const store = &state->stores[place][thread->view.at[place]];
        if (store->releases) {
            see(&thread->fenced, &store->view);
        }
        if (store->releases && place < BYTE && !is_weak(place, false)) {
            see(&thread->view, &store->view);
        }
        *result() = store->value;
    }
    return *result();
}

static void store(unsigned place, uint16_t value, bool closes)
{
    if (is_new_access(1)) {
        note_writes();
        add(place, value, !is_weak(place, closes));
    }
}

static uint16_t read_byte(const tmini_ring_t *ring)
{
    const unsigned at = (unsigned)(ring->tail & (ring->size - 1));
    if (is_dma()) {
        return load(BYTE + at);
    }
    if (is_new_access(1)) {
        must_have_seen(BYTE + at, "a race: a byte is read while it is written");
        add(READ + at, 0, false);
        *result() = tmini_ring_peek(ring, 0);
    }
    return *result();
}

/* ---- What the library calls ---- */

/* Of the ring's members that both sides use. */
static unsigned place_of(const size_t *value)
{
    return value == &work.ring.head ? HEAD : value == &work.ring.tail ? TAIL : OVERRUN;
}

/* An index has two small numbers: how often it was closed or opened, and the bytes it counts. */
size_t tmini_load(const size_t *value)
{
    const uint16_t loaded = load(place_of(value));
    return (loaded >> 8) * TMINI_RING_CLOSED + (loaded & 0xFFu);
}

void tmini_store(size_t *value, size_t stored)
{
    const bool closes = stored - *value >= TMINI_RING_CLOSED; /* Or opens. */
    const size_t small = stored / TMINI_RING_CLOSED << 8 | stored % TMINI_RING_CLOSED;
    if (value != &work.ring.size) { /* Nothing runs while it is set up. */
        store(place_of(value), (uint16_t)small, closes);
    }
    *value = stored;
}

void tmini_fence(void)
{
    if (is_new_access(1) && !is_weak(FENCE, false)) {
        see(&thread->view, &thread->fenced);
    }
}

/* ---- The operations ---- */

static void judge(unsigned byte)
{
    if (byte <= work.last) {
        wrong = "a byte comes twice, or too late";
    } else if (byte != work.last + 1u && !work.found_closed) {
        wrong = "bytes are missing, and the ring was never found closed";
    } else if (byte == work.last + 1u && work.found_closed) {
        wrong = "the ring was found closed where no byte is missing";
    }
    work.last = (uint8_t)byte;
    work.found_closed = false;
}

/* The parser's way through a ring that the CPU feeds (tmini_parser.c): takes a byte; if there is
 * none and the ring is closed, opens it. */
static void take(void)
{
    tmini_ring_t *const ring = &work.ring;
    const size_t ahead = tmini_ring_ahead(ring);
    if (ahead > ring->window && ahead == TMINI_RING_CLOSED) {
        const size_t counted = tmini_ring_overrun(ring);
        /* Each refused byte is a store to OVERRUN. */
        if (counted < state->stores[HEAD][thread->view.at[HEAD]].view.at[OVERRUN]) {
            wrong = "the ring is found closed, and what was refused is not counted";
        }
        work.found_closed = true;
        tmini_ring_open(ring);
    } else if (ahead > 0) {
        judge(read_byte(ring));
        tmini_ring_discard(ring, 1);
    }
}

/* The same with DMA: drops bytes that may be overwritten, reads a byte, and asks whether it was
 * intact. */
static void take_from_dma(void)
{
    tmini_ring_t *const ring = &work.ring;
    const size_t ahead = tmini_ring_ahead(ring);
    if (ahead > ring->window) {
        tmini_ring_discard(ring, ahead - ring->window);
    }
    if (ahead > 0) {
        const unsigned byte = read_byte(ring);
        if (tmini_ring_intact(ring) && byte != ring->tail + 1) {
            wrong = "a wrong byte is found intact";
        }
        tmini_ring_discard(ring, 1);
    }
}

static void operate(void)
{
    const unsigned cell = work.turns & (bounds.size - 1);
    const uint8_t byte = (uint8_t)(work.turns + 1);
    switch (thread->operation) {
    case PUT:
        tmini_ring_put(&work.ring, byte);
        break;
    case GAP: /* The byte was lost before it reached the ring. */
        tmini_ring_gap(&work.ring);
        break;
    case TAKE:
        take();
        break;
    case WRITE:
        store(BYTE + cell, byte, false);
        break;
    case PUBLISH:
        tmini_ring_publish(&work.ring, cell);
        work.turns--;
        break;
    default:
        take_from_dma();
        break;
    }
    work.turns++;
}

/* At most half the ring of DMA is not yet published. */
static bool may_begin(operation_t operation)
{
    const bool is_consumer = thread == &state->threads[CONSUMER];
    const size_t unpublished = thread->work.turns - thread->work.ring.head;
    if (is_consumer != (operation == TAKE || operation == TAKE_FROM_DMA)) {
        return false;
    }
    if (operation == PUBLISH) {
        return unpublished > 0;
    }
    return thread->work.turns < bounds.turns[is_consumer] &&
           (operation != WRITE || unpublished < bounds.size / 2);
}

/* One access of the thread, of this operation. False: it has no such access or value. */
static bool step(operation_t operation)
{
    if (thread->made > 0 ? thread->operation != operation : !may_begin(operation)) {
        return false;
    }
    thread->operation = (uint8_t)operation;
    accesses = 0;
    work = thread->work;
    for (unsigned at = 0; at < CELLS; at++) {
        memory[at] = newest_byte(at);
    }
    switch (setjmp(stopped)) {
    case RUNS:
        operate();
        note_writes();
        memset(thread->values, 0, sizeof thread->values);
        thread->work = work;
        thread->made = 0;
        return true;
    case PAUSES:
        note_writes();
        thread->made++;
        return true;
    default:
        return false;
    }
}

/* ---- Exploring ---- */

static void explore(const state_t *from)
{
    for (unsigned number = 0; number < THREADS; number++) {
        for (unsigned option = 0; option < OPERATIONS * STORES_MAX && wrong == NULL; option++) {
            state_t next = *from;
            state = &next;
            thread = &next.threads[number];
            choice = option % STORES_MAX;
            if (step(bounds.first + option / STORES_MAX) && wrong == NULL && is_new_state(&next)) {
                explore(&next);
            }
        }
    }
}

/* Returns the first error found, or NULL. */
static const char *run(const bounds_t *within, access_t weak)
{
    static state_t first;
    bounds = *within;
    weakened = weak;
    wrong = NULL;
    states = 0;
    seen_hashes = calloc(hashes, sizeof *seen_hashes);
    give_up(seen_hashes == NULL, "no memory");
    memset(&first, 0, sizeof first);
    give_up(tmini_ring_init(&work.ring, memory, bounds.size, is_dma()) != TMINI_OK, "no ring");
    first.threads[PRODUCER].work.ring = work.ring;
    first.threads[CONSUMER].work.ring = work.ring;
    explore(&first);
    free(seen_hashes);
    return wrong;
}

static const struct {
    access_t access;
    const char *name;
    bool dma;
    bool is_needed;
} barriers[] = {
    {{NOTHING, 0, false}, "as it is", false, false},
    {{PUT, TAIL, false}, "put: tail, acquire", false, true},
    {{PUT, HEAD, false}, "put: head, release", false, true},
    {{PUT, OVERRUN, false}, "refuse: overrun, release", false, false},
    {{PUT, HEAD, true}, "refuse: head, release", false, true},
    {{GAP, TAIL, false}, "gap: tail, acquire", false, false},
    {{GAP, HEAD, true}, "gap: head, release", false, true},
    {{TAKE, HEAD, false}, "ahead: head, acquire", false, true},
    {{TAKE, TAIL, false}, "discard: tail, release", false, true},
    {{TAKE, TAIL, true}, "open: tail, release", false, true},
    {{TAKE, OVERRUN, false}, "overrun, acquire", false, false},
    {{NOTHING, 0, false}, "DMA, as it is", true, false},
    {{PUBLISH, HEAD, false}, "publish: head, release", true, true},
    {{TAKE_FROM_DMA, HEAD, false}, "DMA, ahead: head, acquire", true, true},
    {{TAKE_FROM_DMA, FENCE, false}, "intact: fence", true, true},
};

int main(int argc, char **argv)
{
    const bool is_long = argc == 2 && strcmp(argv[1], "--long") == 0;
    const bounds_t by_cpu = {PUT, is_long ? 4 : 2, {is_long ? 6 : 5, is_long ? 8 : 7}};
    const bounds_t by_dma = {WRITE, 4, {is_long ? 10 : 8, is_long ? 5 : 4}};
    bool is_right = argc == 1 || is_long;
    hashes = (size_t)1 << (is_long ? 25 : 21);
    for (size_t i = 0; i < sizeof barriers / sizeof barriers[0]; i++) {
        const bounds_t *const within = barriers[i].dma ? &by_dma : &by_cpu;
        const char *const found = run(within, barriers[i].access);
        const bool is_expected = (found != NULL) == barriers[i].is_needed;
        printf("%-30s %9" PRIu64 " states  %s%s\n", barriers[i].name, states,
               found != NULL ? found : "holds", is_expected ? "" : "  UNEXPECTED");
        is_right = is_right && is_expected;
    }
    return is_right ? 0 : 1;
}
