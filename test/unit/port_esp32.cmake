# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

# The ESP32 port, over mocks of the parts of ESP-IDF that it uses.
set(esp_idf ${CMAKE_CURRENT_SOURCE_DIR}/../support/esp_idf)
set(port_esp32 ${PROJECT_SOURCE_DIR}/port/esp32)
tmini_add_unit_test(test_port_esp32
    SOURCES test_port_esp32.c ${port_esp32}/tmini_esp32.c
    MOCKS ${esp_idf}/driver/uart.h ${esp_idf}/esp_timer.h
          ${esp_idf}/freertos/queue.h ${esp_idf}/freertos/task.h
    LIBRARIES tmini_test_support NOT_ON int16)
if(TARGET test_port_esp32)
    target_include_directories(test_port_esp32 PRIVATE ${port_esp32} ${esp_idf})
endif()
