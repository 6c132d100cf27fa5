/* The tests of abuse, one file per kind. Every call gets a code; nothing crashes, and nothing that is not the call's is
 * written to. */

#ifndef ABUSE_H
#define ABUSE_H

#include "check.h"

#include <stdint.h>

/* Not where anything lies that begins with a number of more than one byte. */
#define CROOKED(type, pointer) ((type)(void *)((uintptr_t)(void *)(pointer) + 1))

/* A call that fails with whichever code and leaves a variable as it was. */
#define FAILS_OUT(out, call)                                                                              \
    (fill(&(out), sizeof(out)), forget_fault(), fails(call, #call, __FILE__, __LINE__),                   \
     CHECK(is_filled(&(out), sizeof(out)), "%s: wrote to %s", #call, #out))
#define FAILS(call) (forget_fault(), fails(call, #call, __FILE__, __LINE__))
int fails(int32_t got, const char *call, const char *file, int line);

void test_null_in_makers(const fixture *f);
void test_null_in_requests(const fixture *f);
void test_null_in_bodies(const fixture *f);
void test_null_in_meshes(const fixture *f);
void test_blend_shape_arguments(const fixture *f);
void test_null_in_clips(const fixture *f);
void test_null_in_motions(const fixture *f);
void test_crooked_pointers(const fixture *f);
void test_no_error_wanted(const fixture *f);

void test_struct_sizes(const fixture *f);
void test_enumerations(const fixture *f);
void test_numbers(const fixture *f);
void test_counts(const fixture *f);
void test_counts_too_large(const fixture *f);
void test_strides(const fixture *f);
void test_texts(const fixture *f);
void test_skin_jobs(const fixture *f);
void test_skin_overlaps(const fixture *f);
void test_sources(const fixture *f);

void test_no_files(const fixture *f);
void test_damaged_models(const fixture *f);
void test_damaged_motions(const fixture *f);

void test_threads(const fixture *f);
void test_orders_of_freeing(const fixture *f);

#endif
