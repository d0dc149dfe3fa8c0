/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Shows the three lines for the user sections of the main.c that CubeMX generates (with a pair of
 * files for each peripheral). All other lines are generated code. */

#include "main.h"
#include "dma.h"
#include "gpio.h"
#include "usart.h"

/* USER CODE BEGIN Includes */
#include "lidar.h"
/* USER CODE END Includes */

void SystemClock_Config(void);

int main(void)
{
    HAL_Init();
    SystemClock_Config();
    MX_GPIO_Init();
    MX_DMA_Init();
    MX_USART1_UART_Init();

    /* USER CODE BEGIN 2 */
    lidar_start(&huart1);
    /* USER CODE END 2 */

    while (1) {
        /* USER CODE BEGIN 3 */
        lidar_work();
        /* USER CODE END 3 */
    }
}
