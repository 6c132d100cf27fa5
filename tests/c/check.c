/* What the tests in C have in common; see check.h. */

#include "check.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

anthronet_error fault;

static char first_complaint[1024];
static int complaints;

#define CANARY 0x5A

int check(int held, const char *file, int line, const char *format, ...) {
    if (!held && complaints++ == 0) {
        const char *name = strrchr(file, '/');
        int used = snprintf(first_complaint, sizeof first_complaint, "%s:%d: ", name ? name + 1 : file, line);
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(first_complaint + used, sizeof first_complaint - (size_t)used, format, arguments);
        va_end(arguments);
    }
    return held;
}

void forget_fault(void) {
    memset(&fault, CANARY, sizeof fault);
    fault.message[sizeof fault.message - 1] = 0;
}

int succeeded(int32_t got, const char *call, const char *file, int line) {
    return check(got == ANTHRONET_OK, file, line, "%s: %d: %s", call, got, fault.message);
}

int refused(int32_t expected, int32_t got, const char *call, const char *file, int line) {
    size_t length = 0;
    if (!check(got == expected, file, line, "%s: expected %d, got %d", call, expected, got)) return 0;
    if (!check(fault.code == expected, file, line, "%s: the error says %d", call, fault.code)) return 0;
    while (length < sizeof fault.message && fault.message[length] != 0) length++;
    check(length > 0 && length < sizeof fault.message, file, line, "%s: its message has %u bytes", call,
          (unsigned)length);
    return check(fault.message[0] != CANARY, file, line, "%s: no message", call);
}

void fill(void *bytes, size_t count) { memset(bytes, CANARY, count); }

int is_filled(const void *bytes, size_t count) {
    const unsigned char *at = (const unsigned char *)bytes;
    size_t i;
    for (i = 0; i < count; i++) {
        if (at[i] != CANARY) return 0;
    }
    return 1;
}

int is_text(anthronet_text text, const char *words) {
    return text.data != NULL && text.length == strlen(words) && memcmp(text.data, words, strlen(words)) == 0;
}

int contains_freed(anthronet_bytes *bytes, const char *words) {
    const uint8_t *data = NULL;
    uint64_t length = 0, at;
    size_t size = strlen(words);
    int found = 0;
    if (!OK(anthronet_bytes_data(bytes, &data, &length, &fault))) return 0;
    for (at = 0; !found && at + size <= length; at++) found = memcmp(data + at, words, size) == 0;
    anthronet_bytes_free(bytes);
    return found;
}

void *room(size_t bytes) {
    void *memory = malloc(bytes > 0 ? bytes : 1);
    if (memory == NULL) {
        fprintf(stderr, "no %lu bytes of memory\n", (unsigned long)bytes);
        exit(3);
    }
    return memory;
}

unsigned char *read_file(const char *path, uint64_t *out_length) {
    FILE *file = fopen(path, "rb");
    long length = -1;
    unsigned char *bytes;
    if (file != NULL && fseek(file, 0, SEEK_END) == 0) length = ftell(file);
    if (length < 0) {
        fprintf(stderr, "%s: cannot read\n", path);
        exit(3);
    }
    rewind(file);
    bytes = (unsigned char *)room((size_t)length);
    *out_length = fread(bytes, 1, (size_t)length, file);
    fclose(file);
    return bytes;
}

void write_file(const char *path, const void *bytes, size_t length) {
    FILE *file = fopen(path, "wb");
    if (file == NULL || fwrite(bytes, 1, length, file) != length) {
        fprintf(stderr, "%s: cannot write\n", path);
        exit(3);
    }
    fclose(file);
}

const char *path_in(const fixture *f, const char *name) {
    static char path[1024];
    snprintf(path, sizeof path, "%s/%s", f->folder, name);
    return path;
}

anthronet_request *person(uint32_t sex, double height) {
    anthronet_request *request = NULL;
    OK(anthronet_request_new(&request, &fault));
    OK(anthronet_request_set_sex(request, sex, &fault));
    OK(anthronet_request_set_measure(request, TEXT("height"), height, &fault));
    return request;
}

anthronet_request *nobody(void) {
    anthronet_request *request = person(ANTHRONET_SEX_FEMALE, 1.50);
    OK(anthronet_request_set_measure(request, TEXT("arm_length"), 0.40, &fault));
    OK(anthronet_request_set_measure(request, TEXT("forearm_length"), 0.17, &fault));
    OK(anthronet_request_set_measure(request, TEXT("waist_circumference"), 1.3, &fault));
    OK(anthronet_request_set_measure(request, TEXT("neck_circumference"), 0.28, &fault));
    return request;
}

anthronet_transform *rest_pose(const fixture *f, const anthronet_body *body, uint32_t space) {
    anthronet_joint *joints = (anthronet_joint *)room(f->joints * sizeof *joints);
    anthronet_transform *pose = (anthronet_transform *)room(f->joints * sizeof *pose);
    uint32_t j;
    int k;
    OK(anthronet_body_joints(body, space, joints, f->joints, &fault));
    for (j = 0; j < f->joints; j++) {
        pose[j] = joints[j].parent_from_joint;
        if (joints[j].parent >= 0) {
            /* The parent's rotation, then its translation, over this joint's. */
            const anthronet_transform *parent = &pose[joints[j].parent], here = pose[j];
            const float *a = parent->rotation, *b = here.rotation, *t = here.translation;
            float cross[3], again[3];
            cross[0] = 2 * (a[1] * t[2] - a[2] * t[1]);
            cross[1] = 2 * (a[2] * t[0] - a[0] * t[2]);
            cross[2] = 2 * (a[0] * t[1] - a[1] * t[0]);
            again[0] = a[1] * cross[2] - a[2] * cross[1];
            again[1] = a[2] * cross[0] - a[0] * cross[2];
            again[2] = a[0] * cross[1] - a[1] * cross[0];
            for (k = 0; k < 3; k++) {
                pose[j].translation[k] = parent->translation[k] + t[k] + a[3] * cross[k] + again[k];
            }
            pose[j].rotation[0] = a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1];
            pose[j].rotation[1] = a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0];
            pose[j].rotation[2] = a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3];
            pose[j].rotation[3] = a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2];
        }
    }
    free(joints);
    return pose;
}

const char BVH[] =
    "HIERARCHY\n"
    "ROOT Hips\n{\n OFFSET 0 0 0\n CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
    " JOINT Spine\n {\n  OFFSET 0 20 0\n  CHANNELS 3 Zrotation Xrotation Yrotation\n"
    "  JOINT Head\n  {\n   OFFSET 0 40 0\n   CHANNELS 3 Zrotation Xrotation Yrotation\n"
    "   End Site\n   {\n    OFFSET 0 20 0\n   }\n  }\n"
    "  JOINT LeftArm\n  {\n   OFFSET 20 30 0\n   CHANNELS 3 Zrotation Xrotation Yrotation\n"
    "   JOINT LeftForeArm\n   {\n    OFFSET 28 0 0\n    CHANNELS 3 Zrotation Xrotation Yrotation\n"
    "    End Site\n    {\n     OFFSET 25 0 0\n    }\n   }\n  }\n"
    "  JOINT RightArm\n  {\n   OFFSET -20 30 0\n   CHANNELS 3 Zrotation Xrotation Yrotation\n"
    "   JOINT RightForeArm\n   {\n    OFFSET -28 0 0\n    CHANNELS 3 Zrotation Xrotation Yrotation\n"
    "    End Site\n    {\n     OFFSET -25 0 0\n    }\n   }\n  }\n }\n"
    " JOINT LeftUpLeg\n {\n  OFFSET 10 0 0\n  CHANNELS 3 Zrotation Xrotation Yrotation\n"
    "  JOINT LeftLeg\n  {\n   OFFSET 0 -42 0\n   CHANNELS 3 Zrotation Xrotation Yrotation\n"
    "   JOINT LeftFoot\n   {\n    OFFSET 0 -42 0\n    CHANNELS 3 Zrotation Xrotation Yrotation\n"
    "    End Site\n    {\n     OFFSET 0 -5 15\n    }\n   }\n  }\n }\n"
    " JOINT RightUpLeg\n {\n  OFFSET -10 0 0\n  CHANNELS 3 Zrotation Xrotation Yrotation\n"
    "  JOINT RightLeg\n  {\n   OFFSET 0 -42 0\n   CHANNELS 3 Zrotation Xrotation Yrotation\n"
    "   JOINT RightFoot\n   {\n    OFFSET 0 -42 0\n    CHANNELS 3 Zrotation Xrotation Yrotation\n"
    "    End Site\n    {\n     OFFSET 0 -5 15\n    }\n   }\n  }\n }\n}\n"
    "MOTION\nFrames: 3\nFrame Time: 0.0333333\n"
    "0 90 0 0 0 0 0 0 0 0 0 0 0 0 -60 0 0 0 0 0 60 0 0 0 0 0 20 0 0 5 0 0 0 0 0 -20 0 0 5 0 0 0\n"
    "0 90 3 0 0 0 0 5 0 0 0 0 0 0 -55 0 0 10 0 0 55 0 0 0 0 0 10 0 0 9 0 0 0 0 0 -10 0 0 5 0 0 0\n"
    "0 90 6 0 0 0 0 0 0 0 0 0 0 0 -60 0 0 0 0 0 60 0 0 0 0 0 0 0 0 5 0 0 0 0 0 0 0 0 5 0 0 0\n";

void fixture_make(fixture *f) {
    anthronet_body_summary summary;
    anthronet_mesh_options options;
    SIZED(summary);
    SIZED(options);
    options.lod = 2;
    OK(anthronet_model_open_embedded(&f->model, &fault));
    f->request = person(ANTHRONET_SEX_FEMALE, 1.70);
    OK(anthronet_generate(f->model, f->request, &f->body, &fault));
    OK(anthronet_body_summarise(f->body, &summary, &fault));
    f->joints = summary.joint_count;
    OK(anthronet_mesh_new(f->body, &options, &f->mesh, &fault));
    OK(anthronet_skinner_new(f->mesh, 0, &f->skinner, &fault));
    OK(anthronet_clip_builtin(TEXT("walk"), f->body, &f->walk, &fault));
    OK(anthronet_motion_open_memory((const uint8_t *)BVH, strlen(BVH), TEXT("steps.bvh"), NULL, &f->motion, &fault));
}

void fixture_free(fixture *f) {
    /* What others were made of goes first: nothing may need it. */
    anthronet_model_free(f->model);
    anthronet_request_free(f->request);
    anthronet_body_free(f->body);
    anthronet_mesh_free(f->mesh);
    anthronet_skinner_free(f->skinner);
    anthronet_clip_free(f->walk);
    anthronet_motion_free(f->motion);
}

/* Prints the case that ends here. */
static int case_ends(const char *name) {
    int failed = complaints > 0;
    if (failed) printf("FAILED %s: %s (%d in all)\n", name, first_complaint, complaints);
    else printf("ok %s\n", name);
    fflush(stdout);
    complaints = 0;
    return failed;
}

int run_tests(int argc, char **argv, const test *tests, size_t count) {
    fixture f;
    size_t i;
    int failed = 0;
    if (argc < 3) {
        fprintf(stderr, "usage: %s MODEL FOLDER [few]\n", argv[0]);
        return 2;
    }
    ZERO(f);
    f.model_path = argv[1];
    f.folder = argv[2];
    f.few = argc > 3 && strcmp(argv[3], "few") == 0;
    fixture_make(&f);
    failed += case_ends("what the tests need is made");
    if (failed) return 1;
    for (i = 0; i < count; i++) {
        tests[i].run(&f);
        failed += case_ends(tests[i].name);
    }
    fixture_free(&f);
    return failed > 0;
}
