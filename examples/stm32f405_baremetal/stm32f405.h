/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The few registers of the STM32F405 that this firmware uses; names and addresses as in reference
 * manual RM0090 and in ARM's manual of the Cortex-M4. */

#ifndef STM32F405_H
#define STM32F405_H

#include <stdint.h>

#define REGISTER(address) (*(volatile uint32_t *)(uintptr_t)(address))

/* Reset and clock control. */
#define RCC_CR REGISTER(0x40023800u)
#define RCC_CR_HSEON (1u << 16)
#define RCC_CR_HSERDY (1u << 17)
#define RCC_CR_PLLON (1u << 24)
#define RCC_CR_PLLRDY (1u << 25)
#define RCC_PLLCFGR REGISTER(0x40023804u)
#define RCC_PLLCFGR_SRC_HSE (1u << 22)
#define RCC_CFGR REGISTER(0x40023808u)
#define RCC_CFGR_SW_PLL (2u << 0)
#define RCC_CFGR_SWS_MASK (3u << 2)
#define RCC_CFGR_SWS_PLL (2u << 2)
#define RCC_CFGR_PPRE1_DIV4 (5u << 10)
#define RCC_CFGR_PPRE2_DIV2 (4u << 13)
#define RCC_AHB1ENR REGISTER(0x40023830u)
#define RCC_AHB1ENR_GPIOA (1u << 0)
#define RCC_AHB1ENR_GPIOB (1u << 1)
#define RCC_AHB1ENR_DMA2 (1u << 22)
#define RCC_APB1ENR REGISTER(0x40023840u)
#define RCC_APB1ENR_USART2 (1u << 17)
#define RCC_APB1ENR_PWR (1u << 28)
#define RCC_APB2ENR REGISTER(0x40023844u)
#define RCC_APB2ENR_USART1 (1u << 4)

#define PWR_CR REGISTER(0x40007000u)
#define PWR_CR_VOS (1u << 14)

#define FLASH_ACR REGISTER(0x40023C00u)
#define FLASH_ACR_5_WAIT_STATES (5u << 0)
#define FLASH_ACR_PREFETCH_AND_CACHES (7u << 8)

/* Ports A and B. */
#define GPIOA_MODER REGISTER(0x40020000u)
#define GPIOA_PUPDR REGISTER(0x4002000Cu)
#define GPIOA_AFRL REGISTER(0x40020020u)
#define GPIOA_AFRH REGISTER(0x40020024u)
#define GPIOB_MODER REGISTER(0x40020400u)
#define GPIOB_BSRR REGISTER(0x40020418u)

#define USART1_BASE 0x40011000u
#define USART1_IRQ 37u
#define USART_DR_OFFSET 4u

/* DMA2, stream 2. */
#define DMA2_STREAM2_IRQ 58u
#define DMA2_LISR REGISTER(0x40026400u)
#define DMA2_LIFCR REGISTER(0x40026408u)
#define DMA_STREAM2_HT (1u << 20)
#define DMA_STREAM2_TC (1u << 21)
#define DMA_STREAM2_ALL (0x3Du << 16)
#define DMA2_S2CR REGISTER(0x40026440u)
#define DMA_SCR_EN (1u << 0)
#define DMA_SCR_HTIE (1u << 3)
#define DMA_SCR_TCIE (1u << 4)
#define DMA_SCR_CIRC (1u << 8)
#define DMA_SCR_MINC (1u << 10)
#define DMA_SCR_CHANNEL(channel) ((channel##u) << 25)
#define DMA2_S2NDTR REGISTER(0x40026444u)
#define DMA2_S2PAR REGISTER(0x40026448u)
#define DMA2_S2M0AR REGISTER(0x4002644Cu)

#define USART2_SR REGISTER(0x40004400u)
#define USART2_DR REGISTER(0x40004404u)
#define USART2_BRR REGISTER(0x40004408u)
#define USART2_CR1 REGISTER(0x4000440Cu)
#define USART_SR_RXNE (1u << 5)
#define USART_SR_TXE (1u << 7)
#define USART_CR1_RE (1u << 2)
#define USART_CR1_TE (1u << 3)
#define USART_CR1_UE (1u << 13)

/* Registers of the processor core. */
#define SYSTICK_CTRL REGISTER(0xE000E010u)
#define SYSTICK_CTRL_ON (7u << 0) /* Enabled, with interrupt, from the processor's clock. */
#define SYSTICK_LOAD REGISTER(0xE000E014u)
#define SYSTICK_VAL REGISTER(0xE000E018u)
#define NVIC_ISER(irq) REGISTER(0xE000E100u + (irq) / 32u * 4u)
#define NVIC_BIT(irq) (1u << ((irq) % 32u))

#endif
