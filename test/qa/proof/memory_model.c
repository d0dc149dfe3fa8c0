/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* memory_model [--long]
 *
 * Explores the ring's protocol exhaustively, as two cores may see it: every interleaving, and
 * every value that a load may return with C11's release and acquire; first with all barriers,
 * then with one at a time weakened to relaxed. Exit status 0 if the protocol holds with all
 * barriers, and each weakened barrier has the effect given in the table at the end: the protocol
 * breaks, or holds (if this barrier is not needed).
 *
 * The model: each index has only one writer, and a list of the values stored to it. A thread's
 * view is the place that it has reached in each list. A load returns any value from there on. An
 * acquire load also takes over the view that the release store had. The model does not let a
 * later relaxed store by the same thread release, too: C11 does, but no longer C++20. If the CPU
 * feeds the ring, its bytes are plain memory: two accesses that are not ordered are a race. DMA
 * writes the bytes without the CPU: a load of a byte returns any value that the view permits,
 * and the hardware writes in the order of time, after whatever was published before.
 *
 * Indices have 8 bits, so that they wrap; adding 64, a quarter of their range, closes the ring.
 *
 * The model checks: there is no race; bytes come in order; if and only if bytes are missing, the
 * ring was found closed there; when it is found closed, the bytes refused before are counted; with
 * DMA, a byte that was read and then found intact is the right byte.
 *
 * States already explored are stored as hashes of 64 bits. */

#include <inttypes.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { HEAD, TAIL, OVERRUN, CELL, CELLS = 4, LOCATIONS = CELL + CELLS };
enum { PRODUCER, CONSUMER, THREADS };

/* The step of a thread that has ended. */
#define ENDED 255

#define STORES_MAX 12

/* The producer adds this to its index to close the ring. */
#define CLOSED 64u

typedef struct {
    uint8_t value;
    uint8_t refused; /* If this store closes the ring: number of bytes refused before it. */
    uint8_t seen[LOCATIONS];
    uint8_t clock[THREADS];
} store_t;

typedef struct {
    uint8_t at; /* Its next step. */
    uint8_t seen[LOCATIONS];
    uint8_t clock[THREADS];
    uint8_t unfenced[LOCATIONS]; /* The view that it would have after a fence. */
    uint8_t index;               /* Its own index: head or tail. */
    uint8_t stop;                /* Producer: the index at which it loads the tail again. */
    uint8_t value;               /* The last value loaded. */
    uint8_t refused; /* Producer: refused bytes; consumer: `refused` of the last store loaded. */
    uint8_t turns;   /* Number of bytes put, or of turns of the parser. */
    uint8_t last;    /* The last byte taken. */
    bool found_closed;
} thread_t;

typedef struct {
    thread_t threads[THREADS];
    uint8_t counts[LOCATIONS];
    store_t stores[LOCATIONS][STORES_MAX];
    uint8_t bytes[CELLS];
    uint8_t written[CELLS]; /* Time of the last write, by the producer's clock. */
    uint8_t read[CELLS];    /* Time of the last read, by the consumer's clock. */
} state_t;

/* The accesses that have an order. */
typedef enum {
    NOTHING,
    CELLS_OWN, /* Accesses to DMA's bytes: never weakened. */
    PUT_LOADS_TAIL,
    PUT_STORES_HEAD,
    REFUSE_STORES_OVERRUN,
    REFUSE_CLOSES,
    GAP_LOADS_TAIL,
    GAP_CLOSES,
    TAKE_LOADS_HEAD,
    TAKE_STORES_TAIL,
    TAKE_OPENS,
    COUNT_LOADS_OVERRUN,
    PUBLISH_STORES_HEAD,
    DMA_TAKE_LOADS_HEAD,
    INTACT_FENCES,
} access_t;

typedef struct {
    unsigned size;
    unsigned turns[THREADS];
    bool dma;
} bounds_t;

static bounds_t bounds;
static access_t weakened;
static const char *wrong;
static uint64_t states;
static uint64_t *seen_hashes;
static size_t seen_capacity;

/* ---- States already explored ---- */

static uint64_t hash_of(const state_t *state)
{
    const uint8_t *const bytes = (const uint8_t *)state;
    uint64_t hash = 0x9E3779B97F4A7C15u;
    for (size_t i = 0; i < sizeof *state; i++) {
        hash = (hash ^ bytes[i]) * 0x100000001B3u;
        hash ^= hash >> 29;
    }
    return hash | 1;
}

static bool insert(uint64_t *table, size_t capacity, uint64_t hash)
{
    size_t at = (size_t)(hash * 0xD6E8FEB86659FD93u >> 20) & (capacity - 1);
    for (; table[at] != 0; at = (at + 1) & (capacity - 1)) {
        if (table[at] == hash) {
            return false;
        }
    }
    table[at] = hash;
    return true;
}

static uint64_t *new_table(size_t capacity)
{
    uint64_t *const table = calloc(capacity, sizeof *table);
    if (table == NULL) {
        (void)fprintf(stderr, "no memory\n");
        exit(2);
    }
    return table;
}

static bool is_new(const state_t *state)
{
    if (2 * states >= seen_capacity) {
        const size_t capacity = 2 * seen_capacity;
        uint64_t *const table = new_table(capacity);
        for (size_t i = 0; i < seen_capacity; i++) {
            if (seen_hashes[i] != 0) {
                (void)insert(table, capacity, seen_hashes[i]);
            }
        }
        free(seen_hashes);
        seen_hashes = table;
        seen_capacity = capacity;
    }
    return insert(seen_hashes, seen_capacity, hash_of(state));
}

/* ---- Memory ---- */

static void see(uint8_t *seen, const uint8_t *other, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        seen[i] = seen[i] > other[i] ? seen[i] : other[i];
    }
}

/* Loads the possible value with the number `choice`; returns false if there are fewer. */
static bool load(state_t *state, thread_t *thread, unsigned location, access_t access,
                 unsigned choice)
{
    const unsigned at = thread->seen[location] + choice;
    if (at >= state->counts[location]) {
        return false;
    }
    const store_t *const store = &state->stores[location][at];
    thread->seen[location] = (uint8_t)at;
    thread->value = store->value;
    thread->refused = store->refused;
    see(thread->unfenced, store->seen, LOCATIONS);
    if (access != weakened && location < CELL) {
        see(thread->seen, store->seen, LOCATIONS);
        see(thread->clock, store->clock, THREADS);
    }
    return true;
}

/* Stores a value. Only the location's writer calls this: it has seen all earlier values. */
static void store(state_t *state, thread_t *thread, unsigned location, access_t access,
                  unsigned value)
{
    const unsigned at = state->counts[location];
    if (at == STORES_MAX) {
        (void)fprintf(stderr, "too many stores for the model\n");
        exit(2);
    }
    store_t *const stored = &state->stores[location][at];
    state->counts[location]++;
    thread->seen[location] = (uint8_t)at;
    stored->value = (uint8_t)value;
    stored->seen[location] = (uint8_t)at;
    if (access != weakened) {
        see(stored->seen, thread->seen, LOCATIONS);
        see(stored->clock, thread->clock, THREADS);
    }
}

static void write_byte(state_t *state, unsigned at, uint8_t value)
{
    thread_t *const thread = &state->threads[PRODUCER];
    if (state->read[at] > thread->clock[CONSUMER]) {
        wrong = "a race: a byte is overwritten while it is read";
    }
    state->bytes[at] = value;
    state->written[at] = ++thread->clock[PRODUCER];
}

static uint8_t read_byte(state_t *state, unsigned at)
{
    thread_t *const thread = &state->threads[CONSUMER];
    if (state->written[at] > thread->clock[PRODUCER]) {
        wrong = "a race: a byte is read while it is written";
    }
    state->read[at] = ++thread->clock[CONSUMER];
    return state->bytes[at];
}

/* ---- tmini_ring_put() and tmini_ring_gap(), one access per step ---- */

enum { PUT_BEGINS, PUT_BYTE, PUT_HEAD, PUT_REFUSES, PUT_REFUSES_FULL, PUT_CLOSES, GAP_CLOSE };

/* At the beginning of a put, choices from this number on mean a gap: the byte was lost before it
 * reached the ring. */
#define GAP STORES_MAX

static void next_put(thread_t *thread)
{
    thread->turns++;
    thread->at = thread->turns == bounds.turns[PRODUCER] ? ENDED : PUT_BEGINS;
    thread->value = 0;
}

/* At its stop, the producer determines how far it may go: at most to the end of the memory. */
static bool look_ahead(state_t *state, thread_t *thread, unsigned choice)
{
    const uint8_t refused = thread->refused;
    if (!load(state, thread, TAIL, PUT_LOADS_TAIL, choice)) {
        return false;
    }
    const uint8_t room = (uint8_t)(thread->value + bounds.size - thread->index);
    const uint8_t to_end = (uint8_t)(bounds.size - (thread->index & (bounds.size - 1)));
    thread->refused = refused;
    if (room == 0 || room > bounds.size) {
        thread->at = room == 0 ? PUT_REFUSES_FULL : PUT_REFUSES;
    } else {
        thread->stop = (uint8_t)(thread->index + (room < to_end ? room : to_end));
        thread->at = PUT_BYTE;
    }
    return true;
}

static void put_byte(state_t *state, thread_t *thread)
{
    write_byte(state, thread->index & (bounds.size - 1), (uint8_t)(thread->turns + 1));
    thread->at = PUT_HEAD;
}

static bool begin_put(state_t *state, thread_t *thread, unsigned choice)
{
    if (thread->index == thread->stop) {
        return look_ahead(state, thread, choice);
    }
    put_byte(state, thread);
    return choice == 0;
}

static bool begin_gap(state_t *state, thread_t *thread, unsigned choice)
{
    const uint8_t refused = thread->refused;
    if (!load(state, thread, TAIL, GAP_LOADS_TAIL, choice)) {
        return false;
    }
    thread->refused = refused;
    if ((uint8_t)(thread->value + bounds.size - thread->index) <= bounds.size) {
        thread->at = GAP_CLOSE;
    } else {
        next_put(thread);
    }
    return true;
}

static void close_ring(state_t *state, thread_t *thread, access_t access)
{
    thread->index = (uint8_t)(thread->index + CLOSED);
    thread->stop = thread->index;
    store(state, thread, HEAD, access, thread->index);
    state->stores[HEAD][thread->seen[HEAD]].refused = thread->refused;
    next_put(thread);
}

static bool put(state_t *state, unsigned choice)
{
    thread_t *const thread = &state->threads[PRODUCER];
    switch (thread->at) {
    case PUT_BEGINS:
        return choice < GAP ? begin_put(state, thread, choice)
                            : begin_gap(state, thread, choice - GAP);
    case PUT_BYTE:
        put_byte(state, thread);
        break;
    case PUT_HEAD:
        thread->index++;
        store(state, thread, HEAD, PUT_STORES_HEAD, thread->index);
        next_put(thread);
        break;
    case PUT_REFUSES:
    case PUT_REFUSES_FULL:
        thread->refused++;
        store(state, thread, OVERRUN, REFUSE_STORES_OVERRUN, thread->refused);
        if (thread->at == PUT_REFUSES_FULL) {
            thread->at = PUT_CLOSES;
        } else {
            next_put(thread);
        }
        break;
    case PUT_CLOSES:
        close_ring(state, thread, REFUSE_CLOSES);
        break;
    case GAP_CLOSE:
        close_ring(state, thread, GAP_CLOSES);
        break;
    default:
        return false;
    }
    return choice == 0;
}

/* ---- The parser: takes a byte; if there is none and the ring is closed, opens the ring ---- */

enum {
    TAKE_BEGINS,
    TAKE_UNREAD,
    TAKE_BYTE,
    TAKE_TAIL,
    TAKE_CLOSED,
    TAKE_AGAIN,
    TAKE_COUNT,
    TAKE_OPEN
};

static void next_take(thread_t *thread)
{
    thread->turns++;
    thread->at = thread->turns == bounds.turns[CONSUMER] ? ENDED : TAKE_BEGINS;
    thread->value = 0;
    thread->refused = 0;
}

static void judge(thread_t *thread, uint8_t byte)
{
    if (byte <= thread->last) {
        wrong = "a byte comes twice, or too late";
    } else if (byte != thread->last + 1 && !thread->found_closed) {
        wrong = "bytes are missing, and the ring was never found closed";
    } else if (byte == thread->last + 1 && thread->found_closed) {
        wrong = "the ring was found closed where no byte is missing";
    }
    thread->last = byte;
    thread->found_closed = false;
}

/* The result of tmini_ring_ahead() with the loaded head. */
static uint8_t ahead(const thread_t *thread)
{
    return (uint8_t)(thread->value - thread->index);
}

/* The parser loads the head: in intact_bytes(), then in pass_lost_bytes(). */
static bool look(state_t *state, thread_t *thread, unsigned choice)
{
    if (!load(state, thread, HEAD, TAKE_LOADS_HEAD, choice)) {
        return false;
    }
    const bool is_closed = ahead(thread) > bounds.size;
    const bool is_empty = ahead(thread) % CLOSED == 0;
    switch (thread->at) {
    case TAKE_BEGINS:
        thread->at = is_closed ? TAKE_UNREAD : is_empty ? TAKE_CLOSED : TAKE_BYTE;
        break;
    case TAKE_UNREAD:
        thread->at = is_empty ? TAKE_CLOSED : TAKE_BYTE;
        break;
    case TAKE_CLOSED:
        thread->at = TAKE_AGAIN;
        if (!is_closed) {
            next_take(thread);
        }
        break;
    default:
        thread->at = TAKE_COUNT;
        if (!is_empty) {
            next_take(thread);
        }
        break;
    }
    return true;
}

static void give_back(state_t *state, thread_t *thread, access_t access, unsigned count)
{
    thread->index = (uint8_t)(thread->index + count);
    store(state, thread, TAIL, access, thread->index);
    next_take(thread);
}

static bool count_refused(state_t *state, thread_t *thread, unsigned choice)
{
    const uint8_t refused = thread->refused;
    if (!load(state, thread, OVERRUN, COUNT_LOADS_OVERRUN, choice)) {
        return false;
    }
    if (thread->value < refused) {
        wrong = "the ring is found closed, and what was refused is not counted";
    }
    thread->at = TAKE_OPEN;
    return true;
}

static bool take(state_t *state, unsigned choice)
{
    thread_t *const thread = &state->threads[CONSUMER];
    switch (thread->at) {
    case TAKE_BEGINS:
    case TAKE_UNREAD:
    case TAKE_CLOSED:
    case TAKE_AGAIN:
        return look(state, thread, choice);
    case TAKE_BYTE:
        judge(thread, read_byte(state, thread->index & (bounds.size - 1)));
        thread->at = TAKE_TAIL;
        break;
    case TAKE_TAIL:
        give_back(state, thread, TAKE_STORES_TAIL, 1);
        break;
    case TAKE_COUNT:
        return count_refused(state, thread, choice);
    case TAKE_OPEN:
        thread->found_closed = true;
        give_back(state, thread, TAKE_OPENS, CLOSED);
        break;
    default:
        return false;
    }
    return choice == 0;
}

/* ---- DMA, and tmini_ring_publish() in its interrupts ---- */

/* DMA writes a byte, or publishes its position. At most half the ring is not yet published. */
static bool run_dma(state_t *state, unsigned choice)
{
    thread_t *const thread = &state->threads[PRODUCER];
    const unsigned written = thread->turns;
    const unsigned published = thread->index;
    if (choice == 0 && written < bounds.turns[PRODUCER] &&
        written + 1 <= published + bounds.size / 2) {
        thread->turns++;
        store(state, thread, CELL + (written & (bounds.size - 1)), CELLS_OWN, written + 1);
        return true;
    }
    if (choice == 1 && written > published) {
        thread->index = thread->turns;
        store(state, thread, HEAD, PUBLISH_STORES_HEAD, written);
        return true;
    }
    return false;
}

enum { DMA_BEGINS, DMA_BYTE, DMA_FENCE, DMA_AGAIN };

/* The parser drops bytes that may be overwritten, reads a byte, and checks that it was intact. */
static bool take_from_dma(state_t *state, unsigned choice)
{
    thread_t *const thread = &state->threads[CONSUMER];
    const unsigned window = bounds.size / 2;
    switch (thread->at) {
    case DMA_BEGINS:
        if (!load(state, thread, HEAD, DMA_TAKE_LOADS_HEAD, choice)) {
            return false;
        }
        if (thread->value == thread->index) {
            next_take(thread);
        } else if (thread->value - thread->index > (int)window) {
            thread->index = (uint8_t)(thread->value - window);
        } else {
            thread->at = DMA_BYTE;
        }
        return true;
    case DMA_BYTE:
        if (!load(state, thread, CELL + (thread->index & (bounds.size - 1)), CELLS_OWN, choice)) {
            return false;
        }
        thread->last = thread->value;
        thread->at = DMA_FENCE;
        return true;
    case DMA_FENCE:
        if (weakened != INTACT_FENCES) {
            see(thread->seen, thread->unfenced, LOCATIONS);
        }
        thread->at = DMA_AGAIN;
        return choice == 0;
    case DMA_AGAIN:
        if (!load(state, thread, HEAD, DMA_TAKE_LOADS_HEAD, choice)) {
            return false;
        }
        if (thread->value - thread->index <= (int)window && thread->last != thread->index + 1) {
            wrong = "a wrong byte is found intact";
        }
        thread->index++;
        thread->last = 0;
        next_take(thread);
        return true;
    default:
        return false;
    }
}

/* ---- Exploring ---- */

static bool step(state_t *state, unsigned thread, unsigned choice)
{
    if (state->threads[thread].at == ENDED) {
        return false;
    }
    if (thread == PRODUCER) {
        return bounds.dma ? run_dma(state, choice) : put(state, choice);
    }
    return bounds.dma ? take_from_dma(state, choice) : take(state, choice);
}

static void explore(const state_t *state)
{
    for (unsigned thread = 0; thread < THREADS; thread++) {
        for (unsigned choice = 0; choice < 2 * STORES_MAX && wrong == NULL; choice++) {
            state_t next = *state;
            if (step(&next, thread, choice) && wrong == NULL && is_new(&next)) {
                states++;
                explore(&next);
            }
        }
    }
}

static void begin(state_t *state)
{
    memset(state, 0, sizeof *state);
    for (unsigned location = 0; location < LOCATIONS; location++) {
        state->counts[location] = 1;
    }
}

/* Returns the first error found, or NULL. */
static const char *run(bounds_t within, access_t weak)
{
    state_t state;
    bounds = within;
    weakened = weak;
    wrong = NULL;
    states = 0;
    seen_capacity = 1 << 16;
    seen_hashes = new_table(seen_capacity);
    begin(&state);
    explore(&state);
    free(seen_hashes);
    return wrong;
}

static const struct {
    access_t access;
    const char *name;
    bool dma;
    bool is_needed;
} barriers[] = {
    {NOTHING, "as it is", false, false},
    {PUT_LOADS_TAIL, "put: tail, acquire", false, true},
    {PUT_STORES_HEAD, "put: head, release", false, true},
    {REFUSE_STORES_OVERRUN, "refuse: overrun, release", false, false},
    {REFUSE_CLOSES, "refuse: head, release", false, true},
    {GAP_LOADS_TAIL, "gap: tail, acquire", false, false},
    {GAP_CLOSES, "gap: head, release", false, true},
    {TAKE_LOADS_HEAD, "unread, closed: head, acquire", false, true},
    {TAKE_STORES_TAIL, "discard: tail, release", false, true},
    {TAKE_OPENS, "open: tail, release", false, true},
    {COUNT_LOADS_OVERRUN, "overrun, acquire", false, false},
    {NOTHING, "DMA, as it is", true, false},
    {PUBLISH_STORES_HEAD, "publish: head, release", true, true},
    {DMA_TAKE_LOADS_HEAD, "DMA, unread: head, acquire", true, true},
    {INTACT_FENCES, "intact: fence", true, true},
};

int main(int argc, char **argv)
{
    const bool is_long = argc > 1 && strcmp(argv[1], "--long") == 0;
    const bounds_t by_cpu = {is_long ? 4 : 2, {is_long ? 6 : 5, is_long ? 8 : 7}, false};
    const bounds_t by_dma = {4, {is_long ? 10 : 8, is_long ? 5 : 4}, true};
    bool is_right = true;
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
