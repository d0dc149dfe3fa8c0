/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Stands in for the part of ESP-IDF's HTTP server that examples/bridge uses. */

#ifndef ESP_HTTP_SERVER_H
#define ESP_HTTP_SERVER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "esp_err.h"

#define HTTP_GET 1
#define HTTPD_DEFAULT_CONFIG() \
    {                          \
        0                      \
    }
#define CONFIG_HTTPD_WS_POST_HANDSHAKE_CB_SUPPORT 1

typedef void *httpd_handle_t;

typedef struct {
    httpd_handle_t handle;
    int method;
    int fd; /* The stand-in's own, as the headers are. */
    const char *host;
    const char *origin;
} httpd_req_t;

typedef struct {
    const char *uri;
    int method;
    esp_err_t (*handler)(httpd_req_t *request);
    bool is_websocket;
    esp_err_t (*ws_post_handshake_cb)(httpd_req_t *request);
} httpd_uri_t;

typedef struct {
    uint16_t max_open_sockets;
    uint16_t recv_wait_timeout;
    uint16_t send_wait_timeout;
    bool lru_purge_enable;
    void (*close_fn)(httpd_handle_t server, int fd);
} httpd_config_t;

typedef enum { HTTPD_WS_TYPE_BINARY = 2 } httpd_ws_type_t;
typedef enum { HTTPD_WS_CLIENT_HTTP = 1, HTTPD_WS_CLIENT_WEBSOCKET = 2 } httpd_ws_client_info_t;

typedef struct {
    httpd_ws_type_t type;
    uint8_t *payload;
    size_t len;
} httpd_ws_frame_t;

esp_err_t httpd_start(httpd_handle_t *server, const httpd_config_t *config);
esp_err_t httpd_register_uri_handler(httpd_handle_t server, const httpd_uri_t *uri);
esp_err_t httpd_req_get_hdr_value_str(httpd_req_t *request, const char *name, char *text,
                                      size_t size);
int httpd_req_to_sockfd(httpd_req_t *request);
httpd_ws_client_info_t httpd_ws_get_fd_info(httpd_handle_t server, int fd);
esp_err_t httpd_resp_set_status(httpd_req_t *request, const char *status);
esp_err_t httpd_resp_set_type(httpd_req_t *request, const char *type);
esp_err_t httpd_resp_set_hdr(httpd_req_t *request, const char *name, const char *value);
esp_err_t httpd_resp_send(httpd_req_t *request, const char *text, ssize_t size);
esp_err_t httpd_resp_sendstr(httpd_req_t *request, const char *text);
esp_err_t httpd_queue_work(httpd_handle_t server, void (*work)(void *argument), void *argument);
esp_err_t httpd_ws_send_frame_async(httpd_handle_t server, int fd, httpd_ws_frame_t *frame);
esp_err_t httpd_sess_update_lru_counter(httpd_handle_t server, int fd);
esp_err_t httpd_sess_trigger_close(httpd_handle_t server, int fd);

#endif
