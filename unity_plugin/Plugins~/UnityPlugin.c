/* The entry points of a native Unity plugin, on top of the C interface of libanthronet. SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * Linked with libanthronet.a into the library of the Unity package: `cargo xtask package unity` does it on Linux,
 * Documentation~/platforms.md says how to do it on other platforms. Without it everything but the render thread works.
 */
#include <stddef.h>
#include <stdint.h>

#include "anthronet.h"

#if defined(_WIN32)
#define UNITY_EXPORT __declspec(dllexport)
#define UNITY_API __stdcall
#else
#define UNITY_EXPORT __attribute__((visibility("default")))
#define UNITY_API
#endif

/* The event that skins surfaces: `AnthroRenderEvent.Skin`. */
#define ANTHRONET_UNITY_SKIN 1

/* The event's data: `AnthroSkinBatch`. Everything must stay valid until the event has run. */
typedef struct anthronet_unity_batch {
    anthronet_context *context;
    const anthronet_skin_job *jobs;
    uint32_t count;
    /* Receives the result of anthronet_skin. */
    int32_t status;
} anthronet_unity_batch;

typedef void(UNITY_API *anthronet_unity_event)(int, void *);

static void *interfaces;

/* Unity calls these two by name when it loads the library and before it unloads it. */
UNITY_EXPORT void UNITY_API UnityPluginLoad(void *unity_interfaces) {
    interfaces = unity_interfaces;
}

UNITY_EXPORT void UNITY_API UnityPluginUnload(void) {
    interfaces = NULL;
}

/* Unity's IUnityInterfaces, for native code that draws the skinned surfaces; NULL outside Unity. */
UNITY_EXPORT void *anthronet_unity_interfaces(void) {
    return interfaces;
}

static void UNITY_API on_render_thread(int event, void *data) {
    anthronet_unity_batch *batch = data;
    if (event == ANTHRONET_UNITY_SKIN && batch != NULL) {
        batch->status = anthronet_skin(batch->context, batch->jobs, batch->count, NULL);
    }
}

/* The callback for CommandBuffer.IssuePluginEventAndData. */
UNITY_EXPORT anthronet_unity_event anthronet_unity_render_event(void) {
    return on_render_thread;
}
