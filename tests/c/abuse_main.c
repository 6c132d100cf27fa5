/* What callers do wrong, under sanitizers and valgrind. */

#include "abuse.h"

int fails(int32_t got, const char *call, const char *file, int line) {
    /* A panic is caught, but a defect. */
    return check(got != ANTHRONET_OK && got != ANTHRONET_ERROR_PANIC, file, line, "%s: %d", call, got) &&
           refused(got, got, call, file, line);
}

int main(int argc, char **argv) {
    static const test TESTS[] = {
        {"NULL for what is opened and made", test_null_in_makers},
        {"NULL in requests", test_null_in_requests},
        {"NULL in bodies and joints", test_null_in_bodies},
        {"NULL in meshes, skinners and files", test_null_in_meshes},
        {"NULL and wrong numbers for blend shapes", test_blend_shape_arguments},
        {"NULL in clips", test_null_in_clips},
        {"NULL in motions", test_null_in_motions},
        {"pointers that are not aligned", test_crooked_pointers},
        {"errors that nobody wants", test_no_error_wanted},
        {"struct_size of every size", test_struct_sizes},
        {"numbers of no enumeration", test_enumerations},
        {"numbers that are no measure", test_numbers},
        {"counts that are not those", test_counts},
        {"counts larger than what they count", test_counts_too_large},
        {"strides and buffers", test_strides},
        {"texts that are none", test_texts},
        {"skinning jobs that contradict themselves", test_skin_jobs},
        {"skinning into memory that is used otherwise", test_skin_overlaps},
        {"motions that contradict themselves", test_sources},
        {"files that are not there or not whole", test_no_files},
        {"models of damaged bytes", test_damaged_models},
        {"motions of damaged bytes", test_damaged_motions},
        {"eight threads with one of each", test_threads},
        {"freed in every order", test_orders_of_freeing},
    };
    return run_tests(argc, argv, TESTS, LENGTH(TESTS));
}
