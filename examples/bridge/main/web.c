/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "web.h"

#include <string.h>
#include <unistd.h>

#include "esp_http_server.h"
#include "sdkconfig.h"

#define BROWSERS_MAX 3
#define FRAME_MAX 1400u /* Fits into a packet of Wi-Fi. */
#define NAME_MAX_LENGTH 64u

/* A browser that listens. Each flag is set by one task and cleared by the other. */
typedef struct {
    bool is_taken;     /* Set by the server, cleared by the bridge: then the place is free. */
    bool has_gone;     /* Set by the server. */
    bool is_sending;   /* Set by the bridge: the server sends `frame`. */
    bool has_joined;   /* The bridge's own. */
    int listener;      /* The bridge's own. */
    int fd;            /* Written while the place is free. */
    size_t frame_size; /* Written while nothing is being sent. */
    uint8_t frame[FRAME_MAX];
} browser_t;

extern const char page_begin[] __asm__("_binary_tmini_html_start");
extern const char page_end[] __asm__("_binary_tmini_html_end");

static httpd_handle_t server;
static browser_t browsers[BROWSERS_MAX];

static bool is_set(const bool *flag)
{
    return __atomic_load_n(flag, __ATOMIC_ACQUIRE);
}

static void set(bool *flag, bool value)
{
    __atomic_store_n(flag, value, __ATOMIC_RELEASE);
}

/* --------------------------------------------------------------------------- the server's task */

static const char *header(httpd_req_t *request, const char *name, char text[NAME_MAX_LENGTH])
{
    const esp_err_t error = httpd_req_get_hdr_value_str(request, name, text, NAME_MAX_LENGTH);
    return error == ESP_ERR_NOT_FOUND ? NULL : error == ESP_OK ? text : "?";
}

static bool may_listen(httpd_req_t *request)
{
    char host[NAME_MAX_LENGTH];
    char origin[NAME_MAX_LENGTH];
    return bridge_may_listen(header(request, "Host", host), header(request, "Origin", origin),
                             CONFIG_BRIDGE_HOSTNAME);
}

static esp_err_t refuse(httpd_req_t *request)
{
    (void)httpd_resp_set_status(request, "403 Forbidden");
    return httpd_resp_sendstr(request, "This device has another name.\n");
}

static esp_err_t redirect(httpd_req_t *request)
{
    (void)httpd_resp_set_status(request, "302 Found");
    (void)httpd_resp_set_hdr(request, "Location", "/live");
    return httpd_resp_send(request, NULL, 0);
}

static esp_err_t send_page(httpd_req_t *request)
{
    if (!may_listen(request)) {
        return refuse(request);
    }
    (void)httpd_resp_set_type(request, "text/html; charset=utf-8");
    (void)httpd_resp_set_hdr(request, "Cache-Control", "no-store");
    (void)httpd_resp_set_hdr(request, "X-Frame-Options", "DENY");
    (void)httpd_resp_set_hdr(request, "X-Content-Type-Options", "nosniff");
    return httpd_resp_send(request, page_begin, page_end - page_begin);
}

/* A WebSocket has been opened. A failure closes it. */
static esp_err_t join(httpd_req_t *request)
{
    const int fd = httpd_req_to_sockfd(request);
    if (!may_listen(request) ||
        httpd_ws_get_fd_info(request->handle, fd) != HTTPD_WS_CLIENT_WEBSOCKET) {
        return ESP_FAIL;
    }
    for (browser_t *browser = browsers; browser < browsers + BROWSERS_MAX; browser++) {
        if (!is_set(&browser->is_taken)) {
            browser->fd = fd;
            set(&browser->has_gone, false);
            set(&browser->is_taken, true);
            return ESP_OK;
        }
    }
    return ESP_FAIL;
}

/* Older versions of ESP-IDF call this also for the opening, newer ones join(). Anything else that a
 * listener sends closes its connection. */
static esp_err_t on_stream(httpd_req_t *request)
{
    return request->method == HTTP_GET ? join(request) : ESP_FAIL;
}

static void on_close(httpd_handle_t handle, int fd)
{
    (void)handle;
    for (browser_t *browser = browsers; browser < browsers + BROWSERS_MAX; browser++) {
        if (is_set(&browser->is_taken) && browser->fd == fd) {
            set(&browser->has_gone, true);
        }
    }
    (void)close(fd);
}

static void send_frame(void *argument)
{
    browser_t *const browser = argument;
    httpd_ws_frame_t frame = {
        .type = HTTPD_WS_TYPE_BINARY, .payload = browser->frame, .len = browser->frame_size};
    if (!is_set(&browser->has_gone)) {
        if (httpd_ws_send_frame_async(server, browser->fd, &frame) == ESP_OK) {
            /* When strangers take all sockets, the server closes those that it used least. */
            (void)httpd_sess_update_lru_counter(server, browser->fd);
        } else {
            (void)httpd_sess_trigger_close(server, browser->fd);
        }
    }
    set(&browser->is_sending, false);
}

esp_err_t web_begin(void)
{
    const httpd_uri_t root = {.uri = "/", .method = HTTP_GET, .handler = redirect};
    const httpd_uri_t live = {.uri = "/live", .method = HTTP_GET, .handler = send_page};
    const httpd_uri_t stream = {
        .uri = "/stream",
        .method = HTTP_GET,
        .handler = on_stream,
        .is_websocket = true,
#ifdef CONFIG_HTTPD_WS_POST_HANDSHAKE_CB_SUPPORT
        .ws_post_handshake_cb = join,
#endif
    };
    httpd_config_t config = HTTPD_DEFAULT_CONFIG();
    config.max_open_sockets = BROWSERS_MAX + 2; /* And some that ask for the page. */
    config.lru_purge_enable = true;
    config.send_wait_timeout = 1; /* A browser that takes nothing for a second is left. */
    config.recv_wait_timeout = 1; /* Half a request holds up the browsers for so long. */
    config.close_fn = on_close;
    esp_err_t error = httpd_start(&server, &config);
    error = error == ESP_OK ? httpd_register_uri_handler(server, &root) : error;
    error = error == ESP_OK ? httpd_register_uri_handler(server, &live) : error;
    return error == ESP_OK ? httpd_register_uri_handler(server, &stream) : error;
}

/* --------------------------------------------------------------------------- the bridge's task */

/* The browser has come: it gets a place in the bridge, or is left. */
static void welcome(bridge_t *bridge, browser_t *browser)
{
    browser->listener = bridge_join(bridge);
    browser->has_joined = true;
    if (browser->listener < 0) {
        (void)httpd_sess_trigger_close(server, browser->fd);
    }
}

static void part(bridge_t *bridge, browser_t *browser, uint64_t now_us)
{
    if (browser->has_joined && browser->listener >= 0) {
        bridge_leave(bridge, browser->listener, now_us);
    }
    browser->has_joined = false;
    set(&browser->is_taken, false);
}

static void send_next(bridge_t *bridge, browser_t *browser)
{
    const uint8_t *bytes = NULL;
    size_t count = bridge_next(bridge, browser->listener, &bytes);
    count = count < FRAME_MAX ? count : FRAME_MAX;
    if (count == 0) {
        return;
    }
    memcpy(browser->frame, bytes, count);
    browser->frame_size = count;
    set(&browser->is_sending, true);
    if (httpd_queue_work(server, send_frame, browser) == ESP_OK) {
        bridge_sent(bridge, browser->listener, count);
    } else {
        set(&browser->is_sending, false); /* Its queue is full: later. */
    }
}

void web_serve(bridge_t *bridge, uint64_t now_us)
{
    for (browser_t *browser = browsers; browser < browsers + BROWSERS_MAX; browser++) {
        if (!is_set(&browser->is_taken) || is_set(&browser->is_sending)) {
            continue;
        }
        if (is_set(&browser->has_gone)) {
            part(bridge, browser, now_us);
        } else if (!browser->has_joined) {
            welcome(bridge, browser);
        } else if (browser->listener >= 0) {
            send_next(bridge, browser);
        }
    }
}
