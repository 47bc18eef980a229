/* Prints a profile as a table over the radius, then draws radii and estimates by them what leaves within 1 mm.
 *
 *     cc -std=c99 profile.c $(pkg-config --cflags --libs translucid) -o profile && ./profile dipole 0.8 1.5
 */
#include <stdio.h>
#include <stdlib.h>
#include <translucid.h>

enum { ROWS = 8, SAMPLES = 10000 };

/* Ends the program with the library's message where a call has failed. */
static void check(TranslucidStatus status) {
    if (status != TRANSLUCID_STATUS_OK) {
        fprintf(stderr, "profile: %s\n", translucid_last_error());
        exit(2);
    }
}

int main(int argc, char **argv) {
    const char *model = argc > 1 ? argv[1] : NULL;
    TranslucidAppearance appearance = {
        .surface_albedo = argc > 2 ? atof(argv[2]) : 0.8,
        .mfp = argc > 3 ? atof(argv[3]) : 1.5, /* mm, and so are all lengths */
    };
    TranslucidProfile *exact = NULL, *profile = NULL;
    check(translucid_profile_new(model, &appearance, &exact));
    check(translucid_profile_tabulated(exact, &profile)); /* any model, in constant time */
    check(translucid_profile_free(exact));

    /* Tabulate it between the radii that hold 5 % and 95 % of the light */
    double u[ROWS], r[ROWS], reflectance[ROWS], enclosed[ROWS];
    for (int i = 0; i < ROWS; i++) {
        u[i] = 0.05 + 0.9 * i / (ROWS - 1);
    }
    check(translucid_profile_quantile(profile, u, ROWS, r));
    check(translucid_profile_eval(profile, r, ROWS, reflectance));
    check(translucid_profile_enclosed(profile, r, ROWS, enclosed));
    printf("r,reflectance,enclosed\n");
    for (int i = 0; i < ROWS; i++) {
        printf("%.6g,%.6g,%.6g\n", r[i], reflectance[i], enclosed[i]);
    }

    /* Draw radii; a stratified sequence stands in for random numbers */
    static double radius[SAMPLES], pdf[SAMPLES];
    for (int i = 0; i < SAMPLES; i++) {
        radius[i] = (i + 0.5) / SAMPLES;
    }
    check(translucid_profile_sample(profile, radius, SAMPLES, radius)); /* in place */
    check(translucid_profile_pdf(profile, radius, SAMPLES, pdf));
    double total = 0.0, within = 1.0, expected = 0.0;
    check(translucid_profile_total(profile, &total));
    check(translucid_profile_enclosed(profile, &within, 1, &expected));
    int inside = 0;
    for (int i = 0; i < SAMPLES; i++) {
        inside += radius[i] < within;
    }
    printf("first sample: r %.6g, pdf %.6g\n", radius[0], pdf[0]);
    printf("within %g mm: %.3f by samples, %.3f by the profile\n", within, total * inside / SAMPLES, expected);
    check(translucid_profile_free(profile));

    double error = total * inside / SAMPLES - expected;
    return error < 1e-3 && error > -1e-3 ? 0 : 1;
}
