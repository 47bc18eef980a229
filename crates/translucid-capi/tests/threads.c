/* Many threads with the same handles: all get the numbers that one gets, and each the message of its own failure. */
#define _POSIX_C_SOURCE 200809L
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <translucid.h>

enum { THREADS = 8, ROUNDS = 30, COUNT = 1000 };

static TranslucidProfile *profile;
static TranslucidTable *table;
static TranslucidExact *exact;
static TranslucidWhiteTable *white;
static double u[COUNT], albedos[COUNT], lengths[COUNT], expected[3][COUNT];

#define CHECK(holds)                                                                                                   \
    do {                                                                                                               \
        if (!(holds)) {                                                                                                \
            fprintf(stderr, "threads: line %d: %s: %s\n", __LINE__, #holds, translucid_last_error());                  \
            abort();                                                                                                   \
        }                                                                                                              \
    } while (0)
#define OK(call) CHECK((call) == TRANSLUCID_STATUS_OK)

static void compute(double results[3][COUNT]) {
    OK(translucid_profile_sample(profile, u, COUNT, results[0]));
    OK(translucid_table_sample(table, albedos, lengths, u, COUNT, results[1]));
    OK(translucid_exact_eval(exact, lengths, NULL, 8, results[2], NULL));
}

static void *work(void *argument) {
    int number = *(int *)argument;
    double(*results)[COUNT] = calloc(3, sizeof *results);
    CHECK(results);
    CHECK(strcmp(translucid_last_error(), "") == 0); /* Nothing has failed on this thread */
    for (int round = 0; round < ROUNDS; round++) {
        compute(results);
        CHECK(memcmp(results, expected, sizeof expected) == 0);

        /* A failure is told to the thread that met it */
        double wrong = -1.0 - number;
        char message[100];
        snprintf(message, sizeof message, "r[0] is %g, but must be at least 0", wrong);
        CHECK(translucid_profile_eval(profile, &wrong, 1, &wrong) == TRANSLUCID_STATUS_INVALID_ARGUMENT);
        CHECK(strcmp(translucid_last_error(), message) == 0);

        /* One thread at a time changes a table; others may read it */
        uint64_t photons = 0;
        TranslucidStatus status = translucid_white_table_run(white, (uint64_t)number, 500, 1, NULL, NULL);
        CHECK(status == TRANSLUCID_STATUS_OK || status == TRANSLUCID_STATUS_BUSY);
        OK(translucid_white_table_photons(white, &photons));
        CHECK(photons % 500 == 0);
    }
    free(results);
    return NULL;
}

int main(void) {
    TranslucidAppearance appearance = {0};
    appearance.surface_albedo = 0.7;
    appearance.mfp = 1.0;
    TranslucidProfile *source = NULL;
    OK(translucid_profile_new("dipole", &appearance, &source));
    OK(translucid_profile_tabulated(source, &profile));
    OK(translucid_table_new("normalized-diffusion", &appearance, &table));
    OK(translucid_profile_free(source));
    TranslucidHalfSpace half_space = {0};
    half_space.single_scattering_albedo = 0.9;
    half_space.threads = 1;
    OK(translucid_exact_new(&half_space, &exact));
    TranslucidWalk walk = {0};
    walk.reference_albedo = 0.9;
    OK(translucid_white_table_new(&walk, &white));
    for (int i = 0; i < COUNT; i++) {
        u[i] = (i + 0.5) / COUNT;
        albedos[i] = (i % 97) / 97.0;
        lengths[i] = 0.1 + i % 13;
    }
    compute(expected);

    pthread_t threads[THREADS];
    int numbers[THREADS];
    for (int i = 0; i < THREADS; i++) {
        numbers[i] = i;
        CHECK(pthread_create(&threads[i], NULL, work, &numbers[i]) == 0);
    }
    for (int i = 0; i < THREADS; i++) CHECK(pthread_join(threads[i], NULL) == 0);

    uint64_t photons = 0;
    OK(translucid_white_table_photons(white, &photons));
    CHECK(photons >= 500);
    OK(translucid_profile_free(profile));
    OK(translucid_table_free(table));
    OK(translucid_exact_free(exact));
    OK(translucid_white_table_free(white));
    printf("%d threads agree\n", THREADS);
    return 0;
}
