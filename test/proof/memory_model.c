/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* memory_model
 *
 * Explores the ring's protocol exhaustively as two cores may see it: every interleaving, and every
 * value that C11's release and acquire let a load return. First as it is, then with one barrier at
 * a time weakened to relaxed. Exit status 0 if it holds as it is, and each weakened barrier does
 * what the table at the end says: break it, or (those that order nothing by themselves) not.
 *
 * The model. Each index has a list of the values stored to it, in modification order. A thread has
 * a view: how far it has seen each list. A load returns any value from there on, and an acquire
 * load takes over the view that its release store had. A store goes behind what the thread has
 * seen; of the gate, which has two writers, also before what it has not. The ring's bytes are plain
 * memory when the CPU feeds it: two accesses that are not ordered are a race. DMA writes them
 * behind the CPU's back: a load of one returns any that the view permits, and the hardware's writes
 * are in the order of time, that is behind what was published before.
 *
 * What is asked: no race; the bytes come in order; where some are missing the ring was found
 * closed, and nowhere else; with DMA, what was read and found intact afterwards is the right byte.
 *
 * States that have been seen are remembered by 64 bits of hash. */

#include <inttypes.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { HEAD, LIMIT, GATE, OVERRUN, CELL, CELLS = 4, LOCATIONS = CELL + CELLS };
enum { PRODUCER, CONSUMER, THREADS };

#define STORES_MAX 12

typedef struct {
    uint8_t value;
    uint8_t seen[LOCATIONS];
    uint8_t clock[THREADS];
} store_t;

typedef struct {
    uint8_t at; /* Where its program stands. */
    uint8_t seen[LOCATIONS];
    uint8_t clock[THREADS];
    uint8_t unfenced[LOCATIONS]; /* What a fence would let it see. */
    uint8_t index;               /* Its own: head, or tail. */
    uint8_t gate;
    uint8_t value;
    uint8_t turns; /* Bytes put, or looks taken. */
    uint8_t last;  /* The byte taken last. */
    bool found_closed;
} thread_t;

typedef struct {
    thread_t threads[THREADS];
    uint8_t counts[LOCATIONS];
    store_t stores[LOCATIONS][STORES_MAX];
    uint8_t bytes[CELLS];
    uint8_t written[CELLS]; /* By the producer's clock. */
    uint8_t read[CELLS];    /* By the consumer's. */
} state_t;

/* Each access that is ordered. */
typedef enum {
    NOTHING,
    CELLS_OWN, /* Of DMA's bytes: never weakened. */
    PUT_LOADS_LIMIT,
    PUT_LOADS_GATE,
    PUT_STORES_HEAD,
    REFUSE_STORES_OVERRUN,
    REFUSE_CLOSES_GATE,
    TAKE_LOADS_HEAD,
    TAKE_STORES_LIMIT,
    TAKE_LOADS_GATE,
    TAKE_OPENS_GATE,
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

/* ---- States that have been seen ---- */

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

/* The load's `choice`th possibility, if there are so many. */
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
    see(thread->unfenced, store->seen, LOCATIONS);
    if (access != weakened && location < CELL) {
        see(thread->seen, store->seen, LOCATIONS);
        see(thread->clock, store->clock, THREADS);
    }
    return true;
}

static void move_on(uint8_t *seen, unsigned at)
{
    if (*seen >= at) {
        (*seen)++;
    }
}

/* The views that looked at stores from `at` on now find them one further. */
static void shift(state_t *state, unsigned location, unsigned at)
{
    for (unsigned i = 0; i < THREADS; i++) {
        thread_t *const thread = &state->threads[i];
        move_on(&thread->seen[location], at);
        move_on(&thread->unfenced[location], at);
    }
    for (unsigned other = 0; other < LOCATIONS; other++) {
        for (unsigned i = 0; i < state->counts[other]; i++) {
            move_on(&state->stores[other][i].seen[location], at);
        }
    }
}

static bool store(state_t *state, thread_t *thread, unsigned location, access_t access,
                  unsigned value, unsigned choice)
{
    const unsigned at = thread->seen[location] + 1u + choice;
    if (at > state->counts[location]) {
        return false;
    }
    if (state->counts[location] == STORES_MAX) {
        (void)fprintf(stderr, "too many stores for the model\n");
        exit(2);
    }
    shift(state, location, at);
    store_t *const list = state->stores[location];
    memmove(&list[at + 1], &list[at], (state->counts[location] - at) * sizeof *list);
    state->counts[location]++;
    thread->seen[location] = (uint8_t)at;
    memset(&list[at], 0, sizeof list[at]);
    list[at].value = (uint8_t)value;
    list[at].seen[location] = (uint8_t)at;
    if (access != weakened) {
        see(list[at].seen, thread->seen, LOCATIONS);
        see(list[at].clock, thread->clock, THREADS);
    }
    return true;
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

/* ---- tmini_ring_put(), an access a step ---- */

enum { PUT_BEGINS, PUT_GATE, PUT_BYTE, PUT_HEAD, PUT_REFUSES, PUT_CLOSES, ENDED };

static void next_put(thread_t *thread)
{
    thread->turns++;
    thread->at = thread->turns == bounds.turns[PRODUCER] ? ENDED : PUT_BEGINS;
    thread->gate = 0;
    thread->value = 0;
}

static bool put(state_t *state, unsigned choice)
{
    thread_t *const thread = &state->threads[PRODUCER];
    switch (thread->at) {
    case PUT_BEGINS:
        if (!load(state, thread, LIMIT, PUT_LOADS_LIMIT, choice)) {
            return false;
        }
        thread->at = thread->index != thread->value ? PUT_GATE : PUT_REFUSES;
        return true;
    case PUT_GATE:
        if (!load(state, thread, GATE, PUT_LOADS_GATE, choice)) {
            return false;
        }
        thread->gate = thread->value;
        thread->at = thread->gate != 0 ? PUT_BYTE : PUT_REFUSES;
        return true;
    case PUT_BYTE:
        write_byte(state, thread->index & thread->gate, (uint8_t)(thread->turns + 1));
        thread->at = PUT_HEAD;
        return choice == 0;
    case PUT_HEAD:
        if (!store(state, thread, HEAD, PUT_STORES_HEAD, thread->index + 1u, choice)) {
            return false;
        }
        thread->index++;
        next_put(thread);
        return true;
    case PUT_REFUSES:
        thread->at = PUT_CLOSES;
        return store(state, thread, OVERRUN, REFUSE_STORES_OVERRUN, 0, choice);
    case PUT_CLOSES:
        if (!store(state, thread, GATE, REFUSE_CLOSES_GATE, 0, choice)) {
            return false;
        }
        next_put(thread);
        return true;
    default:
        return false;
    }
}

/* ---- The parser: takes a byte, or, if there is none and the ring closed, opens it ---- */

enum { TAKE_BEGINS, TAKE_BYTE, TAKE_LIMIT, TAKE_GATE, TAKE_AGAIN, TAKE_OPENS };

static void next_take(thread_t *thread)
{
    thread->turns++;
    thread->at = thread->turns == bounds.turns[CONSUMER] ? ENDED : TAKE_BEGINS;
    thread->value = 0;
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

static bool take(state_t *state, unsigned choice)
{
    thread_t *const thread = &state->threads[CONSUMER];
    switch (thread->at) {
    case TAKE_BEGINS:
        if (!load(state, thread, HEAD, TAKE_LOADS_HEAD, choice)) {
            return false;
        }
        thread->at = thread->value != thread->index ? TAKE_BYTE : TAKE_GATE;
        return true;
    case TAKE_BYTE:
        judge(thread, read_byte(state, thread->index & (bounds.size - 1)));
        thread->at = TAKE_LIMIT;
        return choice == 0;
    case TAKE_LIMIT:
        thread->index++;
        if (!store(state, thread, LIMIT, TAKE_STORES_LIMIT, thread->index + bounds.size, choice)) {
            return false;
        }
        next_take(thread);
        return true;
    case TAKE_GATE:
        if (!load(state, thread, GATE, TAKE_LOADS_GATE, choice)) {
            return false;
        }
        if (thread->value != 0) {
            next_take(thread);
        } else {
            thread->at = TAKE_AGAIN;
        }
        return true;
    case TAKE_AGAIN:
        if (!load(state, thread, HEAD, TAKE_LOADS_HEAD, choice)) {
            return false;
        }
        if (thread->value != thread->index) {
            next_take(thread);
        } else {
            thread->at = TAKE_OPENS;
        }
        return true;
    case TAKE_OPENS:
        if (!store(state, thread, GATE, TAKE_OPENS_GATE, bounds.size - 1, choice)) {
            return false;
        }
        thread->found_closed = true;
        next_take(thread);
        return true;
    default:
        return false;
    }
}

/* ---- DMA, and tmini_ring_publish() in its interrupts ---- */

/* Writes on, or publishes; it is never more than half the ring ahead of what it has published. */
static bool run_dma(state_t *state, unsigned choice)
{
    thread_t *const thread = &state->threads[PRODUCER];
    const unsigned written = thread->turns;
    const unsigned published = thread->index;
    if (choice == 0) {
        thread->turns++;
        return written < bounds.turns[PRODUCER] && written + 1 <= published + bounds.size / 2 &&
               store(state, thread, CELL + (written & (bounds.size - 1)), CELLS_OWN, written + 1,
                     0);
    }
    thread->index = thread->turns;
    return choice == 1 && written > published &&
           store(state, thread, HEAD, PUBLISH_STORES_HEAD, written, 0);
}

enum { DMA_BEGINS, DMA_DROPS, DMA_BYTE, DMA_FENCE, DMA_AGAIN };

/* What the parser does: drops what may be overwritten, reads, asks whether it was intact. */
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
            wrong = "another byte is taken for intact";
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
        for (unsigned choice = 0; choice < STORES_MAX && wrong == NULL; choice++) {
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
    state->stores[LIMIT][0].value = (uint8_t)bounds.size;
    state->stores[GATE][0].value = (uint8_t)(bounds.size - 1);
}

/* Returns what goes wrong, or NULL. */
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
    {PUT_LOADS_LIMIT, "put: limit, acquire", false, true},
    {PUT_LOADS_GATE, "put: gate, acquire", false, false},
    {PUT_STORES_HEAD, "put: head, release", false, true},
    {REFUSE_STORES_OVERRUN, "refuse: overrun, release", false, false},
    {REFUSE_CLOSES_GATE, "refuse: gate, release", false, true},
    {TAKE_LOADS_HEAD, "unread: head, acquire", false, true},
    {TAKE_STORES_LIMIT, "discard: limit, release", false, true},
    {TAKE_LOADS_GATE, "is_closed: gate, acquire", false, true},
    {TAKE_OPENS_GATE, "open: gate, release", false, false},
    {NOTHING, "DMA, as it is", true, false},
    {PUBLISH_STORES_HEAD, "publish: head, release", true, true},
    {DMA_TAKE_LOADS_HEAD, "DMA, unread: head, acquire", true, true},
    {INTACT_FENCES, "intact: fence", true, true},
};

int main(int argc, char **argv)
{
    const bool is_long = argc > 1 && strcmp(argv[1], "--long") == 0;
    const bounds_t by_cpu = {is_long ? 4 : 2, {is_long ? 7 : 5, is_long ? 9 : 7}, false};
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
        printf("%-28s %9" PRIu64 " states  %s%s\n", barriers[i].name, states,
               found != NULL ? found : "holds", is_expected ? "" : "  UNEXPECTED");
        is_right = is_right && is_expected;
    }
    return is_right ? 0 : 1;
}
