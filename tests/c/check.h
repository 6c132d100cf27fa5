/* Cases of the tests in C: `ok NAME`, `FAILED NAME: why`. Everything here is C99 and C++17 at once, as are the tests.
 *
 * A test is a function of the fixture; inside, OK, REFUSED and CHECK note what does not hold, and the case goes on. */

#ifndef CHECK_H
#define CHECK_H

#include "../../ffi/include/anthronet.h"

#include <stddef.h>

/* What most tests need, made once. */
typedef struct fixture {
    anthronet_model *model;
    anthronet_request *request;
    /* A woman of 1.70 m. */
    anthronet_body *body;
    /* Her, at level 2, as glTF has it, ready to be drawn. */
    anthronet_mesh *mesh;
    anthronet_skinner *skinner;
    anthronet_clip *walk;
    anthronet_motion *motion;
    uint32_t joints;
    /* Where files may be written, without a separator at the end. */
    const char *folder;
    const char *model_path;
    /* Fewer repetitions, for valgrind. */
    int few;
} fixture;

typedef struct test {
    const char *name;
    void (*run)(const fixture *);
} test;

/* Of the call that failed last. */
extern anthronet_error fault;

/* Makes the fixture, runs the tests, frees it; what `main` returns. Arguments: MODEL FOLDER [few]. */
int run_tests(int argc, char **argv, const test *tests, size_t count);

/* Makes or frees what the fixture holds. */
void fixture_make(fixture *f);
void fixture_free(fixture *f);

int check(int held, const char *file, int line, const char *format, ...);
int succeeded(int32_t got, const char *call, const char *file, int line);
int refused(int32_t expected, int32_t got, const char *call, const char *file, int line);
/* Makes `fault` recognisably nobody's. */
void forget_fault(void);
void fill(void *bytes, size_t count);
int is_filled(const void *bytes, size_t count);

/* Number of measures, which a test compares with what the library says. */
#define MEASURES 36

/* A condition, and what to say when it does not hold, as for printf. True if it holds. */
#define CHECK(condition, ...) check((condition) ? 1 : 0, __FILE__, __LINE__, __VA_ARGS__)
/* A call that has to succeed. */
#define OK(call) (forget_fault(), succeeded(call, #call, __FILE__, __LINE__))
/* A call that has to fail with a code, and with a message. */
#define REFUSED(expected, call) (forget_fault(), refused(expected, call, #call, __FILE__, __LINE__))
/* A call that has to fail and to leave a variable as it was. */
#define REFUSED_OUT(expected, out, call)                                                                  \
    (fill(&(out), sizeof(out)), REFUSED(expected, call),                                                  \
     CHECK(is_filled(&(out), sizeof(out)), "%s: wrote to %s", #call, #out))
#define TEXT(literal) literal, (uint64_t)(sizeof(literal) - 1)
#define LENGTH(array) (sizeof(array) / sizeof((array)[0]))
#define ZERO(variable) memset(&(variable), 0, sizeof(variable))
/* A structure of zeros that knows its size. */
#define SIZED(variable) (ZERO(variable), (void)((variable).struct_size = (uint32_t)sizeof(variable)))

/* Whether a text of the library's is these words. */
int is_text(anthronet_text text, const char *words);
/* Whether bytes contain a text, and frees them. */
int contains_freed(anthronet_bytes *bytes, const char *words);
/* Allocates or ends the program. */
void *room(size_t bytes);
/* A whole file; ends the program if there is none. */
unsigned char *read_file(const char *path, uint64_t *out_length);
void write_file(const char *path, const void *bytes, size_t length);
/* The fixture's folder and a name: valid until the next call. */
const char *path_in(const fixture *f, const char *name);
/* A request for a sex and height, metres. */
anthronet_request *person(uint32_t sex, double height);
/* One whose measures no person has together: refused, unless the nearest are asked for. */
anthronet_request *nobody(void);
/* All joints of the fixture's body relative to the model, at rest. */
anthronet_transform *rest_pose(const fixture *f, const anthronet_body *body, uint32_t space);
/* A small motion: three frames of a person who walks, as .bvh. */
extern const char BVH[];

#endif
