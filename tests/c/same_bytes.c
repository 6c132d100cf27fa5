/* The hashes of the files of a list of requests, one line each; ffi/tests/same_bytes.rs says how. Argument: the list. */

#include "check.h"
#include "sha256.h"

#include <stdlib.h>

int main(int argc, char **argv) {
    anthronet_model *model = NULL;
    char line[8192], hash[65];
    uint32_t number;
    FILE *list = argc == 2 ? fopen(argv[1], "rb") : NULL;
    if (list == NULL) {
        fprintf(stderr, "usage: %s REQUESTS\n", argv[0]);
        return 2;
    }
    if (anthronet_model_open_embedded(&model, NULL) != ANTHRONET_OK) return 1;
    for (number = 0; fgets(line, sizeof line, list) != NULL; number++) {
        anthronet_request *request = NULL;
        anthronet_body *body = NULL;
        anthronet_bytes *bytes = NULL;
        anthronet_clip *walk = NULL;
        const anthronet_clip *clips[1];
        anthronet_export_options options;
        const uint8_t *data = NULL;
        uint64_t length = 0;
        int32_t code;
        SIZED(options);
        options.lod = number % 4;
        code = anthronet_request_from_json(line, strcspn(line, "\n"), &request, NULL);
        if (code == ANTHRONET_OK) code = anthronet_generate(model, request, &body, NULL);
        if (code == ANTHRONET_OK && number % 10 == 3) {
            code = anthronet_clip_builtin(TEXT("walk"), body, &walk, NULL);
            clips[0] = walk;
            options.clips = clips;
            options.clip_count = 1;
        }
        if (code == ANTHRONET_OK) code = anthronet_export_memory(body, &options, TEXT("glb"), &bytes, NULL);
        if (code == ANTHRONET_OK) code = anthronet_bytes_data(bytes, &data, &length, NULL);
        if (code == ANTHRONET_OK) {
            sha256(data, length, hash);
            puts(hash);
        } else {
            printf("error %d\n", code);
        }
        anthronet_request_free(request);
        anthronet_body_free(body);
        anthronet_clip_free(walk);
        anthronet_bytes_free(bytes);
    }
    anthronet_model_free(model);
    fclose(list);
    return 0;
}
