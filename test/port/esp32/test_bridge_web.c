/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* The bridge's pages and WebSockets, over a stand-in for ESP-IDF's HTTP server. */

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "unity.h"

#include "bridge.h"
#include "esp_http_server.h"
#include "web.h"

/* As ESP-IDF embeds a file. */
extern const char page[] __asm__("_binary_tmini_html_start");
const char page[] = "<p>the page";
__asm__(".globl _binary_tmini_html_end\n"
        ".set _binary_tmini_html_end, _binary_tmini_html_start + 11");

static bridge_t bridge;
static httpd_config_t config;
static httpd_uri_t uris[3];
static unsigned uri_count;
static char answer[200];
static struct {
    void (*work)(void *argument);
    void *argument;
} queue[8];
static unsigned queued;
static esp_err_t queue_result;
static esp_err_t send_result;
static char sent[9000];
static size_t sent_size;
static bool is_websocket;
static int closing;
static int used;

/* ----------------------------------------------------------------------------------- the server */

esp_err_t httpd_start(httpd_handle_t *server, const httpd_config_t *given)
{
    *server = &config;
    config = *given;
    return ESP_OK;
}

esp_err_t httpd_register_uri_handler(httpd_handle_t server, const httpd_uri_t *uri)
{
    TEST_ASSERT_EQUAL_PTR(&config, server);
    uris[uri_count++] = *uri;
    return ESP_OK;
}

esp_err_t httpd_req_get_hdr_value_str(httpd_req_t *request, const char *name, char *text,
                                      size_t size)
{
    const char *const value = strcmp(name, "Host") == 0 ? request->host : request->origin;
    if (value == NULL) {
        return ESP_ERR_NOT_FOUND;
    }
    (void)snprintf(text, size, "%s", value);
    return strlen(value) < size ? ESP_OK : ESP_FAIL;
}

int httpd_req_to_sockfd(httpd_req_t *request)
{
    return request->fd;
}

httpd_ws_client_info_t httpd_ws_get_fd_info(httpd_handle_t server, int fd)
{
    (void)server, (void)fd;
    return is_websocket ? HTTPD_WS_CLIENT_WEBSOCKET : HTTPD_WS_CLIENT_HTTP;
}

static esp_err_t add(const char *text)
{
    (void)snprintf(answer + strlen(answer), sizeof answer - strlen(answer), "%s|", text);
    return ESP_OK;
}

esp_err_t httpd_resp_set_status(httpd_req_t *request, const char *status)
{
    (void)request;
    return add(status);
}

esp_err_t httpd_resp_set_type(httpd_req_t *request, const char *type)
{
    (void)request;
    return add(type);
}

esp_err_t httpd_resp_set_hdr(httpd_req_t *request, const char *name, const char *value)
{
    (void)request, (void)name;
    return add(value);
}

esp_err_t httpd_resp_send(httpd_req_t *request, const char *text, ssize_t size)
{
    char copy[100] = "";
    (void)request;
    (void)snprintf(copy, sizeof copy, "%.*s", (int)size, text != NULL ? text : "");
    return add(copy);
}

esp_err_t httpd_resp_sendstr(httpd_req_t *request, const char *text)
{
    return httpd_resp_send(request, text, (ssize_t)strlen(text));
}

esp_err_t httpd_queue_work(httpd_handle_t server, void (*work)(void *argument), void *argument)
{
    (void)server;
    if (queue_result == ESP_OK) {
        TEST_ASSERT_LESS_THAN_UINT(8, queued);
        queue[queued].work = work;
        queue[queued++].argument = argument;
    }
    return queue_result;
}

esp_err_t httpd_ws_send_frame_async(httpd_handle_t server, int fd, httpd_ws_frame_t *frame)
{
    (void)server, (void)fd;
    TEST_ASSERT_EQUAL_INT(HTTPD_WS_TYPE_BINARY, frame->type);
    memcpy(sent + sent_size, frame->payload, frame->len);
    sent_size += send_result == ESP_OK ? frame->len : 0;
    return send_result;
}

esp_err_t httpd_sess_update_lru_counter(httpd_handle_t server, int fd)
{
    (void)server;
    used = fd;
    return ESP_OK;
}

esp_err_t httpd_sess_trigger_close(httpd_handle_t server, int fd)
{
    (void)server;
    closing = fd;
    return ESP_OK;
}

/* ------------------------------------------------------------------------------------ the tests */

/* The server does what the bridge has asked it for. */
static void work(void)
{
    for (unsigned i = 0; i < queued; i++) {
        queue[i].work(queue[i].argument);
    }
    queued = 0;
}

static void close_session(int fd)
{
    config.close_fn(&config, fd);
    web_serve(&bridge, 1);
}

static esp_err_t ask(const char *uri, const char *host, const char *origin)
{
    httpd_req_t request = {&config, HTTP_GET, 0, host, origin};
    answer[0] = '\0';
    for (unsigned i = 0; i < uri_count; i++) {
        if (strcmp(uris[i].uri, uri) == 0) {
            return uris[i].handler(&request);
        }
    }
    return ESP_FAIL;
}

/* Opens a WebSocket; returns its descriptor, or -1 if it is refused. */
static int open_stream(const char *origin, bool is_old)
{
    httpd_req_t request = {&config, HTTP_GET, dup(0), "192.168.4.1", origin};
    TEST_ASSERT_TRUE(uris[2].is_websocket);
    const esp_err_t error =
        is_old ? uris[2].handler(&request) : uris[2].ws_post_handshake_cb(&request);
    if (error != ESP_OK) {
        (void)close(request.fd);
        return -1;
    }
    web_serve(&bridge, 1);
    return request.fd;
}

void setUp(void)
{
    memset(&bridge, 0, sizeof bridge);
    uri_count = 0;
    queued = 0;
    queue_result = send_result = ESP_OK;
    sent_size = 0;
    is_websocket = true;
    closing = used = -1;
    TEST_ASSERT_EQUAL_INT(ESP_OK, web_begin());
}

void tearDown(void)
{
    for (int fd = 3; fd < 12; fd++) {
        close_session(fd);
    }
    work();
    web_serve(&bridge, 1);
}

void test_a_browser_gets_the_page(void)
{
    TEST_ASSERT_EQUAL_INT(ESP_OK, ask("/", "anything", NULL));
    TEST_ASSERT_EQUAL_STRING("302 Found|/live||", answer);
    TEST_ASSERT_EQUAL_INT(ESP_OK, ask("/live", "lidar", NULL));
    TEST_ASSERT_EQUAL_STRING("text/html; charset=utf-8|no-store|DENY|nosniff|<p>the page|", answer);
    TEST_ASSERT_EQUAL_INT(ESP_OK, ask("/live", "evil.example", NULL));
    TEST_ASSERT_EQUAL_STRING("403 Forbidden|This device has another name.\n|", answer);
    (void)ask("/live",
              "192.168.4.1.192.168.4.1.192.168.4.1.192.168.4.1.192.168.4.1.192.168.4.1.192.168.4.1",
              NULL);
    TEST_ASSERT_EQUAL_STRING("403 Forbidden|This device has another name.\n|", answer);
}

void test_a_listener_gets_what_comes_frame_by_frame(void)
{
    uint8_t part[1000];
    memset(part, 'x', sizeof part);
    for (int is_old = 0; is_old < 2; is_old++) { /* ESP-IDF before and since the callback. */
        sent_size = 0;
        const int fd = open_stream("http://192.168.4.1", is_old > 0);
        TEST_ASSERT_GREATER_THAN_INT(2, fd);
        TEST_ASSERT_TRUE(bridge_is_wanted(&bridge, 1));
        bridge_pass(&bridge, 5, part, sizeof part);
        bridge_pass(&bridge, 5, part, sizeof part);
        web_serve(&bridge, 5);
        web_serve(&bridge, 5); /* The first frame has not been sent yet: nothing is queued. */
        work();
        TEST_ASSERT_EQUAL_size_t(1400, sent_size);
        TEST_ASSERT_EQUAL_INT(fd, used); /* A flood of other connections closes them first. */
        queue_result = ESP_FAIL;         /* The server is busy: nothing is lost. */
        web_serve(&bridge, 5);
        queue_result = ESP_OK;
        web_serve(&bridge, 5);
        work();
        TEST_ASSERT_EQUAL_size_t(8 + 2 * 1010, sent_size);
        TEST_ASSERT_EQUAL_MEMORY("\x89tmini\x02\n\xA7\xC3", sent, 10);
        web_serve(&bridge, 5);
        TEST_ASSERT_EQUAL_UINT(0, queued);
        close_session(fd);
        TEST_ASSERT_FALSE(bridge_is_wanted(&bridge, 1 + BRIDGE_LINGER_US));
    }
}

void test_who_must_not_listen_or_sends_something_is_left(void)
{
    httpd_req_t frame = {.method = 0};
    TEST_ASSERT_EQUAL_INT(-1, open_stream("http://evil.example", false));
    is_websocket = false; /* A plain request. */
    TEST_ASSERT_EQUAL_INT(-1, open_stream(NULL, true));
    is_websocket = true;
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_GREATER_THAN_INT(2, open_stream(NULL, false));
    }
    TEST_ASSERT_EQUAL_INT(-1, open_stream(NULL, false)); /* One too many. */
    TEST_ASSERT_EQUAL_INT(ESP_FAIL, uris[2].handler(&frame));
}

void test_a_listener_that_takes_nothing_is_left(void)
{
    const int fd = open_stream(NULL, false);
    web_serve(&bridge, 5);
    send_result = ESP_FAIL;
    work();
    TEST_ASSERT_EQUAL_INT(fd, closing);
    close_session(fd);
    TEST_ASSERT_FALSE(bridge_is_wanted(&bridge, 1 + BRIDGE_LINGER_US));
}

void test_a_listener_that_goes_while_a_frame_is_queued_gets_no_more(void)
{
    const int fd = open_stream(NULL, false);
    web_serve(&bridge, 5);
    TEST_ASSERT_EQUAL_UINT(1, queued);
    close_session(fd);
    TEST_ASSERT_TRUE(bridge_is_wanted(&bridge, 1 + BRIDGE_LINGER_US)); /* Its place is in use. */
    work();
    TEST_ASSERT_EQUAL_size_t(0, sent_size);
    web_serve(&bridge, 5);
    TEST_ASSERT_FALSE(bridge_is_wanted(&bridge, 5 + BRIDGE_LINGER_US));
}

void test_a_browser_for_which_the_bridge_has_no_place_is_left(void)
{
    for (int i = 0; i < BRIDGE_LISTENERS_MAX; i++) {
        (void)bridge_join(&bridge); /* By TCP. */
    }
    const int fd = open_stream(NULL, false);
    TEST_ASSERT_EQUAL_INT(fd, closing);
    bridge_leave(&bridge, 3, 5);
    close_session(fd);
    TEST_ASSERT_GREATER_THAN_INT(2, open_stream(NULL, false));
    TEST_ASSERT_TRUE(bridge.listeners[3].is_used);
}
