/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* memory_model [--long]
 *
 * Explores the library's ring exhaustively, as two cores may see it: every interleaving, and every
 * value that a load may return with C11's release and acquire; first with all barriers, then with
 * one at a time weakened to relaxed. Exit status 0 if the ring holds with all barriers, and each
 * weakened barrier has the effect given in the table at the end: the ring breaks, or holds (if
 * this barrier is not needed).
 *
 * The ring is compiled with modelled_atomic.h. A step of a thread runs its operation from the
 * beginning: accesses that it has made before return what they returned then, the next one is
 * made, and the one after that ends the step.
 *
 * The model: each index has only one writer, and a list of the values stored to it. A thread's view
 * is the place that it has reached in each list. A load returns any value from there on. An acquire
 * load also takes over the view that the release store had. The model does not let a later relaxed
 * store by the same thread release, too: C11 does, but no longer C++20. If the CPU feeds the ring,
 * its bytes are plain memory: two accesses that are not ordered are a race. DMA writes the bytes
 * without the CPU: a load of a byte returns any value that the view permits, and the hardware
 * writes in the order of time, after whatever was published before.
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

enum { HEAD, TAIL, OVERRUN, CELL, CELLS = 4, LOCATIONS = CELL + CELLS, FENCE };
enum { PRODUCER, CONSUMER, THREADS };

#define STORES_MAX 12u
#define ACCESSES_MAX 8u /* Of one operation. */

/* A value of an index: how often it was closed or opened, and the bytes that it counts. */
typedef struct {
    uint8_t closed;
    uint8_t bytes;
    uint8_t refused; /* If the store of this value closes the ring: bytes refused before it. */
} value_t;

typedef struct {
    value_t value;
    uint8_t seen[LOCATIONS];
    uint8_t clock[THREADS];
} store_t;

typedef enum { PUT, GAP, TAKE, WRITE_BY_DMA, PUBLISH, TAKE_FROM_DMA, NOTHING } operation_t;

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
    uint8_t made;                 /* Accesses of that operation. */
    value_t values[ACCESSES_MAX]; /* What these returned. */
    uint8_t seen[LOCATIONS];
    uint8_t clock[THREADS];
    uint8_t unfenced[LOCATIONS]; /* The view that it would have after a fence. */
} thread_t;

typedef struct {
    thread_t threads[THREADS];
    uint8_t counts[LOCATIONS];
    store_t stores[LOCATIONS][STORES_MAX];
    uint8_t bytes[CELLS];
    uint8_t written[CELLS]; /* Time of the last write, by the producer's clock. */
    uint8_t read[CELLS];    /* Time of the last read, by the consumer's clock. */
} state_t;

/* An access that has an order: a load or store of this location by this operation, and whether the
 * store closes or opens the ring. */
typedef struct {
    operation_t operation;
    unsigned location;
    bool closes;
} access_t;

typedef struct {
    unsigned size;
    unsigned turns[THREADS];
    bool dma;
} bounds_t;

static bounds_t bounds;
static access_t weakened;
static const char *wrong;

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

static bool is_new(const state_t *state)
{
    const uint64_t hash = hash_of(state);
    size_t at = (size_t)(hash * 0xD6E8FEB86659FD93u >> 20) & (hashes - 1);
    for (; seen_hashes[at] != hash; at = (at + 1) & (hashes - 1)) {
        if (seen_hashes[at] == 0) {
            give_up(2 * states++ >= hashes, "too many states");
            seen_hashes[at] = hash;
            return true;
        }
    }
    return false;
}

/* ---- The step under way ---- */

static state_t *state;
static thread_t *thread;
static work_t work; /* The thread's, changed by its operation. */
static uint8_t memory[CELLS];
static unsigned accesses; /* Of the operation, in this step. */
static unsigned choice;   /* Which of the possible values the new access returns. */
static jmp_buf stopped;

enum { RUNS, PAUSES, HAS_NO_CHOICE };

/* Ends the step if it has made its access. True: the access is the new one. */
static bool is_new_access(value_t *value)
{
    if (accesses > thread->made) {
        longjmp(stopped, PAUSES);
    }
    give_up(accesses == ACCESSES_MAX, "too many accesses");
    *value = thread->values[accesses];
    return accesses++ == thread->made;
}

static void keep(value_t value)
{
    thread->values[thread->made] = value;
}

static void allow_one_choice(void)
{
    if (choice > 0) {
        longjmp(stopped, HAS_NO_CHOICE);
    }
}

static void see(uint8_t *seen, const uint8_t *other, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        seen[i] = seen[i] > other[i] ? seen[i] : other[i];
    }
}

/* Plain writes of the producer since the last access. All bytes put are different. */
static void note_writes(void)
{
    for (unsigned at = 0; at < CELLS && !bounds.dma; at++) {
        if (memory[at] != state->bytes[at]) {
            if (state->read[at] > thread->clock[CONSUMER]) {
                wrong = "a race: a byte is overwritten while it is read";
            }
            state->bytes[at] = memory[at];
            state->written[at] = ++thread->clock[PRODUCER];
        }
    }
}

static bool is_weak(unsigned location, bool closes)
{
    return weakened.operation == (operation_t)thread->operation && weakened.location == location &&
           weakened.closes == closes;
}

static value_t load(unsigned location)
{
    value_t value;
    if (!is_new_access(&value)) {
        return value;
    }
    const unsigned at = thread->seen[location] + choice;
    if (at >= state->counts[location]) {
        longjmp(stopped, HAS_NO_CHOICE);
    }
    const store_t *const store = &state->stores[location][at];
    note_writes();
    thread->seen[location] = (uint8_t)at;
    see(thread->unfenced, store->seen, LOCATIONS);
    if (location < CELL && !is_weak(location, false)) {
        see(thread->seen, store->seen, LOCATIONS);
        see(thread->clock, store->clock, THREADS);
    }
    keep(store->value);
    return store->value;
}

/* Only the location's writer calls this: it has seen all earlier values. */
static void store(unsigned location, bool closes, value_t value)
{
    value_t unused;
    if (!is_new_access(&unused)) {
        return;
    }
    const unsigned at = state->counts[location]++;
    allow_one_choice();
    give_up(at == STORES_MAX, "too many stores");
    store_t *const stored = &state->stores[location][at];
    note_writes();
    thread->seen[location] = (uint8_t)at;
    stored->value = value;
    stored->seen[location] = (uint8_t)at;
    if (!is_weak(location, closes)) {
        see(stored->seen, thread->seen, LOCATIONS);
        see(stored->clock, thread->clock, THREADS);
    }
}

static uint8_t read_byte(const tmini_ring_t *ring)
{
    const unsigned at = (unsigned)(ring->tail & (ring->size - 1));
    value_t value;
    if (bounds.dma) {
        return load(CELL + at).bytes;
    }
    if (is_new_access(&value)) {
        allow_one_choice();
        if (state->written[at] > thread->clock[PRODUCER]) {
            wrong = "a race: a byte is read while it is written";
        }
        state->read[at] = ++thread->clock[CONSUMER];
        value = (value_t){0, tmini_ring_peek(ring, 0), 0};
        keep(value);
    }
    return value.bytes;
}

/* ---- What the library calls ---- */

static size_t plain(value_t value)
{
    return value.closed * TMINI_RING_CLOSED + value.bytes;
}

static value_t modelled(size_t index, size_t refused)
{
    return (value_t){(uint8_t)(index / TMINI_RING_CLOSED), (uint8_t)(index % TMINI_RING_CLOSED),
                     (uint8_t)refused};
}

static uint8_t refused_before; /* The head loaded last. */

/* Of the ring's members that both sides use. */
static unsigned location_of(const size_t *value)
{
    return value == &work.ring.head ? HEAD : value == &work.ring.tail ? TAIL : OVERRUN;
}

size_t tmini_load(const size_t *value)
{
    const value_t loaded = load(location_of(value));
    if (value == &work.ring.head) {
        refused_before = loaded.refused;
    }
    return plain(loaded);
}

void tmini_store(size_t *value, size_t stored)
{
    const bool closes = stored - *value >= TMINI_RING_CLOSED; /* Or opens. */
    if (value != &work.ring.size) {                           /* Nothing runs while it is set up. */
        store(location_of(value), closes, modelled(stored, closes ? work.ring.overrun : 0));
    }
    *value = stored;
}

void tmini_fence(void)
{
    value_t unused;
    if (is_new_access(&unused)) {
        allow_one_choice();
        if (!is_weak(FENCE, false)) {
            see(thread->seen, thread->unfenced, LOCATIONS);
        }
    }
}

/* ---- The operations ---- */

static void judge(uint8_t byte)
{
    if (byte <= work.last) {
        wrong = "a byte comes twice, or too late";
    } else if (byte != work.last + 1 && !work.found_closed) {
        wrong = "bytes are missing, and the ring was never found closed";
    } else if (byte == work.last + 1 && work.found_closed) {
        wrong = "the ring was found closed where no byte is missing";
    }
    work.last = byte;
    work.found_closed = false;
}

/* The parser's way through a ring that the CPU feeds (tmini_parser.c): takes a byte; if there is
 * none and the ring is closed, opens it. */
static void take(void)
{
    tmini_ring_t *const ring = &work.ring;
    const size_t ahead = tmini_ring_ahead(ring);
    const uint8_t refused = refused_before;
    if (ahead > ring->window && ahead == TMINI_RING_CLOSED) {
        if (tmini_ring_overrun(ring) < refused) {
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
        const uint8_t byte = read_byte(ring);
        if (tmini_ring_intact(ring) && byte != ring->tail + 1) {
            wrong = "a wrong byte is found intact";
        }
        tmini_ring_discard(ring, 1);
    }
}

static void operate(void)
{
    const unsigned cell = work.turns & (bounds.size - 1);
    switch (thread->operation) {
    case PUT:
        tmini_ring_put(&work.ring, (uint8_t)(work.turns + 1));
        break;
    case GAP: /* The byte was lost before it reached the ring. */
        tmini_ring_gap(&work.ring);
        break;
    case WRITE_BY_DMA:
        store(CELL + cell, false, (value_t){0, (uint8_t)(work.turns + 1), 0});
        break;
    case PUBLISH:
        tmini_ring_publish(&work.ring, cell);
        work.turns--;
        break;
    case TAKE:
        take();
        break;
    default:
        take_from_dma();
        break;
    }
    work.turns++;
}

/* At most half the ring of DMA is not yet published. */
static bool may_begin(const work_t *before, unsigned operation)
{
    const size_t unpublished = before->turns - before->ring.head;
    if (operation == PUBLISH) {
        return unpublished > 0;
    }
    return operation != WRITE_BY_DMA || unpublished < bounds.size / 2;
}

/* Chooses an operation if none is under way. The choice's number is one of STORES_MAX values of
 * one of two operations. */
static bool begin_operation(unsigned number)
{
    const unsigned first = thread == &state->threads[CONSUMER] ? TAKE + (bounds.dma ? 3u : 0u)
                           : bounds.dma                        ? WRITE_BY_DMA
                                                               : PUT;
    const unsigned operation = first + number / STORES_MAX;
    const bool is_alone = thread == &state->threads[CONSUMER];
    const bool is_over =
        thread->work.turns == bounds.turns[is_alone ? CONSUMER : PRODUCER] && operation != PUBLISH;
    thread->operation = (uint8_t)operation;
    return !is_over && (operation == first || !is_alone) && may_begin(&thread->work, operation);
}

/* One access of the thread. False: it has no access or value with this number. */
static bool step(state_t *next, unsigned number_of_thread, unsigned number)
{
    state = next;
    thread = &next->threads[number_of_thread];
    choice = number % STORES_MAX;
    if (thread->made == 0 ? !begin_operation(number) : number >= STORES_MAX) {
        return false;
    }
    accesses = 0;
    work = thread->work;
    memcpy(memory, state->bytes, sizeof memory);
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
        for (unsigned option = 0; option < 2 * STORES_MAX && wrong == NULL; option++) {
            state_t next = *from;
            if (step(&next, number, option) && wrong == NULL && is_new(&next)) {
                explore(&next);
            }
        }
    }
}

/* Returns the first error found, or NULL. */
static const char *run(bounds_t within, access_t weak)
{
    static state_t first;
    bounds = within;
    weakened = weak;
    wrong = NULL;
    states = 0;
    seen_hashes = calloc(hashes, sizeof *seen_hashes);
    give_up(seen_hashes == NULL, "no memory");
    memset(&first, 0, sizeof first);
    for (unsigned location = 0; location < LOCATIONS; location++) {
        first.counts[location] = 1;
    }
    give_up(tmini_ring_init(&work.ring, memory, bounds.size, bounds.dma) != TMINI_OK, "no ring");
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
    const bool is_long = argc > 1 && strcmp(argv[1], "--long") == 0;
    const bounds_t by_cpu = {is_long ? 4 : 2, {is_long ? 6 : 5, is_long ? 8 : 7}, false};
    const bounds_t by_dma = {4, {is_long ? 10 : 8, is_long ? 5 : 4}, true};
    bool is_right = true;
    hashes = (size_t)1 << (is_long ? 25 : 21);
    if (argc > (is_long ? 2 : 1)) {
        (void)fprintf(stderr, "usage: memory_model [--long]\n");
        return 2;
    }
    printf("ring of %u, %u puts, %u looks; DMA: ring of %u, %u bytes, %u looks\n", by_cpu.size,
           by_cpu.turns[PRODUCER], by_cpu.turns[CONSUMER], by_dma.size, by_dma.turns[PRODUCER],
           by_dma.turns[CONSUMER]);
    for (size_t i = 0; i < sizeof barriers / sizeof barriers[0]; i++) {
        const char *const found = run(barriers[i].dma ? by_dma : by_cpu, barriers[i].access);
        const bool is_expected = (found != NULL) == barriers[i].is_needed;
        printf("%-30s %9" PRIu64 " states  %s%s\n", barriers[i].name, states,
               found != NULL ? found : "holds", is_expected ? "" : "  UNEXPECTED");
        is_right = is_right && is_expected;
    }
    return is_right ? 0 : 1;
}
