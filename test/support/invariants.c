/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "invariants.h"

#include "tmini_driver.h"

/* As in tmini_command.c, which does not export them. */
#define STEPS_MAX 64
#define STEPS_IN_VAIN 15
#define ASKS_MAX 30
#define CHANCES_MAX 3
#define PLAUSIBLE_CHZ_MAX 2000

/* As in tmini_builder.c: 4 degrees back. */
#define SWEPT_MIN_Q6 (-256)

/* All events that may be pending: from STARTED to LOST. */
#define EVENTS ((1u << TMINI_EVENT_MORE) - (1u << TMINI_EVENT_STARTED))

/* ---- Ring, parser ---- */

/* The producer writes up to its stop without checking. So there must be room up to it, and the
 * memory must not end before it. */
static bool stop_is_sound(const tmini_ring_t *ring)
{
    const size_t known = ring->stop - ring->head;
    const size_t at = ring->head & (ring->size - 1);
    const size_t room = ring->tail + ring->size - ring->head;
    return known == 0 || (known <= ring->size - at && known <= room && room <= ring->size &&
                          ring->origin + ring->head == (uintptr_t)&ring->memory[at]);
}

bool ring_is_sound(const tmini_ring_t *ring)
{
    const size_t size = ring->size;
    if (ring->memory == NULL || size < 2 || size > TMINI_RING_SIZE_MAX ||
        (size & (size - 1)) != 0) {
        return false;
    }
    if (tmini_ring_is_dma(ring)) { /* The hardware may overrun the reader. */
        return ring->window == size / 2 && ring->stop == ring->head;
    }
    return ring->window == size && stop_is_sound(ring) && tmini_ring_unread(ring) <= size &&
           tmini_ring_ahead(ring) / TMINI_RING_CLOSED <= 1; /* Open, or closed once. */
}

static uint8_t samples_in(const tmini_frame_t *frame)
{
    return frame->header[1];
}

static bool has_packet_header(const tmini_parser_t *parser)
{
    const uint8_t *const header = parser->frame.header;
    const bool is_start = (header[0] & 1u) != 0;
    return samples_in(&parser->frame) >= 1 &&
           samples_in(&parser->frame) <= (is_start ? 1 : parser->max_samples) &&
           (header[2] & 1u) != 0 && (header[4] & 1u) != 0;
}

/* `need` fits what is known of the candidate. */
static bool candidate_is_sound(const tmini_parser_t *parser)
{
    const unsigned need = parser->need;
    switch (parser->kind) {
    case TMINI_FRAME_NONE:
        return need == 1 || need == 2 || need == TMINI_PACKET_HEADER_SIZE ||
               (need == TMINI_REPLY_HEADER_SIZE && parser->awaiting);
    case TMINI_FRAME_PACKET:
        return has_packet_header(parser) && need == TMINI_PACKET_SIZE(samples_in(&parser->frame));
    case TMINI_FRAME_REPLY:
        return parser->awaiting && need == TMINI_REPLY_HEADER_SIZE + parser->awaited.length;
    default:
        return false;
    }
}

bool parser_is_sound(const tmini_parser_t *parser)
{
    const tmini_frame_t *const frame = &parser->frame;
    if (frame->ring == NULL || !ring_is_sound(frame->ring)) {
        return false;
    }
    const size_t window = frame->ring->window;
    /* The ring still holds the frame that was delivered. */
    const bool frame_is_sound =
        frame->size == 0 ||
        (frame->size <= window && frame->size <= tmini_ring_unread(frame->ring) &&
         parser->kind == TMINI_FRAME_NONE && parser->need == 1);
    return parser->max_samples >= 1 && TMINI_PACKET_SIZE(parser->max_samples) <= window &&
           (!parser->awaiting || TMINI_REPLY_HEADER_SIZE + parser->awaited.length <= window) &&
           frame_is_sound && candidate_is_sound(parser);
}

uint32_t parser_account(const tmini_parser_t *parser)
{
    tmini_parser_counters_t counters;
    tmini_parser_counters(parser, &counters);
    return counters.bytes_in_packets + counters.bytes_in_replies + counters.bytes_skipped +
           counters.bytes_overrun + (uint32_t)tmini_parser_pending(parser);
}

/* ---- Packet, CT information, scan ---- */

bool packet_is_sound(const tmini_packet_t *packet, const tmini_frame_t *frame)
{
    return packet->frame == frame && packet->first_angle_q6 < TMINI_FULL_CIRCLE_Q6 &&
           packet->last_angle_q6 < TMINI_FULL_CIRCLE_Q6 && packet->count >= 1 &&
           (packet->count == 1 || !tmini_packet_is_start(packet)) &&
           packet->step <= (uint32_t)TMINI_FULL_CIRCLE_Q6 << 17 &&
           (packet->count > 1 || packet->step == 0);
}

/* The number of fields in the first `packets` packets: the indices 1, 3, 4, 5 and 9 to 13. */
static unsigned fields_among(unsigned packets)
{
    static const uint8_t fields[TMINI_CT_INDICES] = {0, 0, 1, 1, 2, 3, 4, 4, 4, 4, 5, 6, 7, 8};
    return packets < TMINI_CT_INDICES ? fields[packets] : TMINI_CT_FIELDS;
}

bool ct_is_sound(const tmini_ct_t *ct)
{
    return ct->packets <= TMINI_CT_INDICES && ct->fields == fields_among(ct->packets) &&
           (ct->known & ~0x2E3Au) == 0; /* The indices that complete what can be known. */
}

bool builder_is_sound(const tmini_builder_t *builder)
{
    const tmini_scan_t *const scan = &builder->scan;
    return builder->capacity > 0 && !(builder->ended && builder->open) &&
           (!builder->open || (scan->packets > 0 && !scan->complete)) && scan->points != NULL &&
           scan->count <= builder->capacity &&
           (builder->filter & ~(unsigned)TMINI_FILTER_BOTH) == 0 &&
           builder->previous_angle_q6 < TMINI_FULL_CIRCLE_Q6 && builder->swept_q6 >= SWEPT_MIN_Q6 &&
           (builder->origin_q6 < TMINI_FULL_CIRCLE_Q6 ||
            (builder->origin_q6 == UINT16_MAX && !builder->open && !builder->ended));
}

/* ---- Driver ---- */

static bool is_code(uint8_t code)
{
    return (code >= TMINI_COMMAND_FASTER_TENTH && code <= TMINI_COMMAND_GET_FREQUENCY) ||
           code == TMINI_COMMAND_REBOOT || code == TMINI_COMMAND_START ||
           code == TMINI_COMMAND_STOP || code == TMINI_COMMAND_GET_INFO ||
           code == TMINI_COMMAND_GET_HEALTH;
}

static bool is_step(uint8_t code)
{
    return code >= TMINI_COMMAND_FASTER_TENTH && code <= TMINI_COMMAND_SLOWER_ONE;
}

/* Events name the operations; TMINI_EVENT_NONE means no operation. */
static bool is_operation(uint8_t event)
{
    return event <= TMINI_EVENT_REBOOTED;
}

static uint8_t code_of(uint8_t operation)
{
    switch (operation) {
    case TMINI_EVENT_STARTED:
        return TMINI_COMMAND_START;
    case TMINI_EVENT_STOPPED:
        return TMINI_COMMAND_STOP;
    case TMINI_EVENT_INFO:
        return TMINI_COMMAND_GET_INFO;
    case TMINI_EVENT_HEALTH:
        return TMINI_COMMAND_GET_HEALTH;
    case TMINI_EVENT_FREQUENCY:
        return TMINI_COMMAND_GET_FREQUENCY;
    default:
        return TMINI_COMMAND_REBOOT;
    }
}

/* The awaited reply is the one to the command sent. */
static bool awaits_its_reply(const tmini_t *lidar)
{
    const tmini_reply_header_t *const awaited = &lidar->decoder.parser.awaited;
    const tmini_reply_header_t *const reply =
        tmini_reply_header((tmini_command_code_t)lidar->command.code);
    return lidar->decoder.parser.awaiting && reply != NULL && awaited->type == reply->type &&
           awaited->mode == reply->mode && awaited->length == reply->length;
}

static bool is_asking(const tmini_command_t *command)
{
    return (command->operation == TMINI_EVENT_FREQUENCY ||
            command->operation == TMINI_EVENT_REBOOTED) &&
           command->code == TMINI_COMMAND_GET_FREQUENCY;
}

static bool is_stepping(const tmini_command_t *command)
{
    return command->operation == TMINI_EVENT_FREQUENCY && is_step(command->code);
}

static bool is_awaiting(const tmini_command_t *command)
{
    return command->code == code_of(command->operation) || is_stepping(command);
}

/* The table of phases: which operation, command and wish each one can have. Of 16 phases and 7
 * operations 32 pairs exist. */
static bool phase_fits(const tmini_t *lidar)
{
    const tmini_command_t *const command = &lidar->command;
    const bool is_starting = command->operation == TMINI_EVENT_STARTED;
    const bool has_none =
        command->operation == TMINI_EVENT_NONE && !tmini_command_is_sending(lidar);
    const bool is_to_scan = tmini_recovery_wishes(lidar, TMINI_EVENT_STARTED);
    const bool is_lost = lidar->recovery.is_lost;
    switch (command->phase) {
    case TMINI_PHASE_NONE:
    case TMINI_PHASE_WATCHING:
    case TMINI_PHASE_IDLE:
        return lidar->recovery.wishes == 0 && !tmini_command_is_sending(lidar);
    case TMINI_PHASE_QUIESCING:
        return command->operation != TMINI_EVENT_NONE && command->code == TMINI_COMMAND_STOP;
    case TMINI_PHASE_SETTLING:
        return command->operation == TMINI_EVENT_FREQUENCY &&
               (is_asking(command) || is_stepping(command));
    case TMINI_PHASE_ASKING:
        return is_asking(command) && awaits_its_reply(lidar);
    case TMINI_PHASE_AWAITING:
        return is_awaiting(command) && awaits_its_reply(lidar);
    case TMINI_PHASE_UNCHANGED:
        return is_stepping(command) && awaits_its_reply(lidar);
    case TMINI_PHASE_SPINNING_UP:
        return is_starting;
    case TMINI_PHASE_TURNING:
    case TMINI_PHASE_STANDING:
        return is_starting && is_lost;
    case TMINI_PHASE_REBOOTING:
        return command->operation == TMINI_EVENT_REBOOTED &&
               command->code == TMINI_COMMAND_REBOOT && command->asks == 0;
    case TMINI_PHASE_PAUSING:
        return has_none && is_to_scan && !lidar->is_listen_only;
    case TMINI_PHASE_LISTENING:
        return has_none && is_to_scan &&
               (lidar->is_listen_only || (lidar->is_recovery_off && is_lost));
    case TMINI_PHASE_SCANNING:
    case TMINI_PHASE_LAST_CHANCE:
        return has_none && lidar->recovery.wishes == 1u << TMINI_EVENT_STARTED && !is_lost;
    default:
        return false;
    }
}

/* A reply is awaited in three phases only. */
static bool awaits_as_it_should(const tmini_t *lidar)
{
    const uint8_t phase = lidar->command.phase;
    return !lidar->decoder.parser.awaiting || phase == TMINI_PHASE_ASKING ||
           phase == TMINI_PHASE_AWAITING || phase == TMINI_PHASE_UNCHANGED;
}

/* What is in progress is wished, or a step of the ladder; a stop is in progress as soon as it is
 * wished. */
static bool operation_is_wished(const tmini_t *lidar)
{
    const uint8_t operation = lidar->command.operation;
    const unsigned wishes = lidar->recovery.wishes;
    const bool is_step = (wishes & 1u << TMINI_EVENT_STARTED) != 0 &&
                         (operation == TMINI_EVENT_FREQUENCY || operation == TMINI_EVENT_REBOOTED);
    const bool is_stopping =
        operation == TMINI_EVENT_STOPPED && lidar->command.phase == TMINI_PHASE_QUIESCING;
    const bool is_only_to_scan = wishes == 1u << TMINI_EVENT_STARTED;
    return ((wishes & 1u << TMINI_EVENT_STOPPED) == 0 || is_stopping) &&
           (operation > TMINI_EVENT_STARTED || is_only_to_scan) &&
           (operation != TMINI_EVENT_REBOOTED || is_only_to_scan ||
            (wishes & 1u << TMINI_EVENT_REBOOTED) != 0) &&
           (operation == TMINI_EVENT_NONE || is_step || (wishes & 1u << operation) != 0);
}

/* Every wish is being carried out. */
static bool wishes_fit(const tmini_t *lidar)
{
    const unsigned wishes = lidar->recovery.wishes;
    const unsigned all = (1u << (TMINI_EVENT_REBOOTED + 1)) - (1u << TMINI_EVENT_STARTED);
    const bool is_busy = lidar->command.phase > TMINI_PHASE_IDLE;
    return (wishes & ~all) == 0 && (wishes != 0) == is_busy &&
           (!is_busy || operation_is_wished(lidar)) &&
           (!lidar->recovery.is_lost || wishes == 1u << TMINI_EVENT_STARTED);
}

/* Nothing; nothing after a half-sent command; two bytes, offered or not; the second one, likewise.
 * (1: the first byte has been sent; 2: the command is being sent; 4: it has not been offered.) */
static bool unsent_is_sound(unsigned unsent)
{
    return unsent <= 3 || unsent == (2 | 4) || unsent == (1 | 2 | 4);
}

/* The same member counts questions, and the chances of a lidar whose packets stay away. */
static unsigned asks_max(uint8_t phase)
{
    return phase >= TMINI_PHASE_SCANNING ? CHANCES_MAX : ASKS_MAX;
}

/* Only a step that has been sent can be in vain. */
static unsigned steps_max(const tmini_command_t *command)
{
    const bool is_sent =
        command->phase == TMINI_PHASE_AWAITING || command->phase == TMINI_PHASE_UNCHANGED;
    return command->operation == TMINI_EVENT_FREQUENCY && is_sent ? STEPS_MAX
                                                                  : STEPS_MAX + STEPS_IN_VAIN;
}

static bool command_is_sound(const tmini_command_t *command)
{
    const bool is_sending = (command->unsent & TMINI_UNSENT) != 0;
    return is_operation(command->operation) && unsent_is_sound(command->unsent) &&
           (!is_sending || (is_code(command->code) && command->phase > TMINI_PHASE_IDLE)) &&
           (command->timeout_ms == 0 || command->phase > TMINI_PHASE_IDLE) &&
           command->steps <= steps_max(command) && command->asks <= asks_max(command->phase) &&
           command->frequency_chz <= PLAUSIBLE_CHZ_MAX;
}

static bool monitor_is_sound(const tmini_monitor_t *monitor)
{
    return ((monitor->faults | monitor->observed) & ~(TMINI_FAULT_MASK | TMINI_FAULT_FREQUENCY)) ==
               0 &&
           monitor->off_times <= 4 && monitor->turns_to_still <= 4;
}

static bool recovery_is_sound(const tmini_recovery_t *recovery)
{
    return recovery->attempts <= 4 && recovery->contact < 8;
}

/* When only listening, no operation runs and no frequency is wanted. */
static bool wish_is_sound(const tmini_t *lidar)
{
    const uint16_t chz = lidar->command.wanted_chz;
    return (chz == 0 || (chz >= TMINI_FREQUENCY_MIN_CHZ && chz <= TMINI_FREQUENCY_MAX_CHZ)) &&
           (!lidar->is_listen_only || (chz == 0 && lidar->command.operation == 0)) &&
           wishes_fit(lidar);
}

/* Without points no scan is built. A packet that waits to be added is sound. If the driver has
 * settled, no event is pending. */
static bool results_are_sound(const tmini_t *lidar)
{
    const tmini_decoder_t *const decoder = &lidar->decoder;
    const bool by_packets = decoder->builder.capacity == 0;
    return (by_packets ? !decoder->builder.open && !decoder->builder.ended
                       : builder_is_sound(&decoder->builder)) &&
           (lidar->idle_ms == 0 || lidar->pending == 0) &&
           (!decoder->builder.ended || packet_is_sound(&decoder->packet, &decoder->parser.frame));
}

bool lidar_is_sound(const tmini_t *lidar)
{
    if (lidar->link.port == NULL) {
        return true;
    }
    return (lidar->link.port->write != NULL || lidar->is_listen_only) &&
           lidar->link.port->now_ms != NULL && lidar->link.timing != NULL &&
           lidar->decoder.parser.frame.ring == &lidar->ring &&
           lidar->ring.window >= TMINI_REPLY_SIZE_MAX && parser_is_sound(&lidar->decoder.parser) &&
           (lidar->pending & ~EVENTS) == 0 && command_is_sound(&lidar->command) &&
           phase_fits(lidar) && awaits_as_it_should(lidar) && monitor_is_sound(&lidar->monitor) &&
           recovery_is_sound(&lidar->recovery) && ct_is_sound(&lidar->decoder.ct) &&
           wish_is_sound(lidar) && results_are_sound(lidar);
}
