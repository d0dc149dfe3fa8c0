/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Stand-in: see pico.h. */

#ifndef HARDWARE_DMA_H
#define HARDWARE_DMA_H

#include "hardware/address_mapped.h"
#include "pico.h"

#define DMA_SIZE_8 0

typedef struct {
    uint chain_to;
    uint dreq;
    uint ring_bits;
    uint data_size;
    bool ring_on_write;
    bool read_increment;
    bool write_increment;
} dma_channel_config;

typedef struct {
    volatile uint32_t transfer_count;
} dma_channel_hw_t;

int dma_claim_unused_channel(bool required);
void dma_channel_unclaim(uint channel);
dma_channel_config dma_channel_get_default_config(uint channel);

/* As in the SDK, these functions only set a member. */
#define SET_MEMBER(function, type, member)                                                   \
    static inline void channel_config_set_##function(dma_channel_config *config, type value) \
    {                                                                                        \
        config->member = value;                                                              \
    }
SET_MEMBER(transfer_data_size, uint, data_size)
SET_MEMBER(read_increment, bool, read_increment)
SET_MEMBER(write_increment, bool, write_increment)
SET_MEMBER(dreq, uint, dreq)
SET_MEMBER(chain_to, uint, chain_to)

static inline void channel_config_set_ring(dma_channel_config *config, bool write, uint size_bits)
{
    config->ring_on_write = write;
    config->ring_bits = size_bits;
}

void dma_channel_configure(uint channel, const dma_channel_config *config, volatile void *write,
                           const volatile void *read, uint32_t transfer_count, bool trigger);
dma_channel_hw_t *dma_channel_hw_addr(uint channel);
void dma_channel_cleanup(uint channel);

#endif
