/* Calls the C library at random with arguments that are mostly right and often not: NULL, NaN, infinities, huge lengths,
 * handles of another type, names that are none and texts that are no UTF-8. The seed is fixed.
 *
 * It fails where a status is none of those that the header names for bad arguments, a failure has no message or has
 * written something, a success has written what is not finite or not plausible, or a function has never succeeded or
 * never been refused. AddressSanitizer sees what else goes wrong: arrays are as long as the call says, to the byte.
 *
 *     fuzz CALLS DIRECTORY
 */
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <translucid.h>

enum { MOST = 40, SLOTS = 6, KINDS = 5 };

/* Random numbers: xorshift64* */

static uint64_t state = 0x9e3779b97f4a7c15u;

static uint64_t bits(void) {
    state ^= state >> 12;
    state ^= state << 25;
    state ^= state >> 27;
    return state * 0x2545f4914f6cdd1du;
}
static size_t below(size_t n) { return (size_t)(bits() >> 11) % n; }
static double uniform(void) { return (double)(bits() >> 11) * 0x1p-53; }
/* One time in n */
static int rarely(size_t n) { return below(n) == 0; }

static const char *current = "";

static void fail(const char *what) {
    fprintf(stderr, "fuzz: %s: %s: %s\n", current, what, translucid_last_error());
    abort();
}

/* Arguments */

static double strange(void) {
    static const double all[] = {0.0, -0.0, 1.0, -1.0, 2.0, DBL_MIN, 5e-324, DBL_MAX, -DBL_MAX, INFINITY, -INFINITY, NAN,
                                 1e-16, 1.0 - 1e-16, 1.0 + 3e-16, 1e-150, 1e150, 1e-100, 1e100, 1e-15, 1e15, 0.999999};
    return all[below(sizeof all / sizeof *all)];
}
static double share(void) { return rarely(12) ? strange() : uniform(); }
static double positive(void) { return rarely(12) ? strange() : pow(10.0, 6.0 * uniform() - 3.0); }
static double cosine(void) { return rarely(4) ? (rarely(4) ? strange() : 1.9 * uniform() - 0.95) : 0.0; }
static double index_of_refraction(void) { return rarely(4) ? (rarely(4) ? strange() : 0.6 + 1.4 * uniform()) : 0.0; }

static const char *long_text(void) {
    static char text[10001];
    memset(text, 'x', sizeof text - 1);
    return text;
}
static const char *wrong_text(void) {
    switch (below(4)) {
    case 0: return "";
    case 1: return "nix";
    case 2: return "\xff\xfe";
    default: return long_text();
    }
}
static const char *one_of(const char *a, const char *b) { return rarely(20) ? wrong_text() : below(2) ? a : b; }
static const char *model(void) { return rarely(20) ? wrong_text() : translucid_model_name(below(11)); }
static const char *configuration(void) { return rarely(3) ? one_of("searchlight", "diffuse") : NULL; }
static const char *side(void) { return rarely(3) ? one_of("reflected", "transmitted") : NULL; }
static size_t huge(void) {
    static const size_t all[] = {SIZE_MAX, SIZE_MAX / 2, SIZE_MAX / 8 + 1, (size_t)PTRDIFF_MAX / 8 + 1};
    return all[below(4)];
}

/* Handles */

typedef enum { PROFILE, TABLE, EXACT, WHITE, CONVERTED } Kind;
static void *slots[KINDS][SLOTS];
static uint64_t nothing[8];

static void *handle(Kind kind) {
    if (rarely(40)) return NULL;
    if (rarely(40)) return nothing;
    if (rarely(40)) kind = (Kind)below(KINDS);
    return slots[kind][below(SLOTS)];
}

static TranslucidStatus free_handle(Kind kind, void *handle) {
    switch (kind) {
    case PROFILE: return translucid_profile_free(handle);
    case TABLE: return translucid_table_free(handle);
    case EXACT: return translucid_exact_free(handle);
    case WHITE: return translucid_white_table_free(handle);
    default: return translucid_converted_free(handle);
    }
}

/* Where a call puts its handle: a slot, unless there is no room */
static void *made;
static void *untouched = &made;
static void **room_for_handle(void) {
    made = untouched;
    return rarely(50) ? NULL : &made;
}

static TranslucidStatus keep(Kind kind, TranslucidStatus status) {
    if (status != TRANSLUCID_STATUS_OK) {
        if (made != untouched) fail("a failure has made a handle");
        return status;
    }
    void **slot = &slots[kind][below(SLOTS)];
    if (free_handle(kind, *slot) != TRANSLUCID_STATUS_OK) fail("a handle cannot be freed");
    *slot = made;
    return status;
}

/* Arrays */

static double *array(size_t count, double (*element)(void)) {
    double *all = malloc(count * sizeof *all + (count == 0));
    for (size_t i = 0; i < count; i++) all[i] = element();
    /* One strange number spoils a whole array: most of them are to be good */
    return all;
}
static double good_share(void) { return uniform(); }
static double good_radius(void) { return pow(10.0, 6.0 * uniform() - 3.0); }
static double *numbers(size_t count, double (*good)(void)) {
    double *all = array(count, good);
    if (count > 0 && rarely(6)) all[below(count)] = strange();
    return all;
}
static double *rising(size_t count) {
    double *all = array(count, good_radius);
    double r = 0.0;
    for (size_t i = 0; i < count; i++) all[i] = r += 0.01 + 0.3 * uniform();
    if (count > 0 && rarely(6)) all[below(count)] = strange();
    return all;
}

static const double SENTINEL = -12345.678;
static double sentinel(void) { return SENTINEL; }

static void check_output(TranslucidStatus status, const double *out, size_t count, double least, double most) {
    for (size_t i = 0; i < count; i++) {
        if (status != TRANSLUCID_STATUS_OK) {
            if (out[i] != SENTINEL) fail("a failure has written a number");
        } else if (!(out[i] >= least && out[i] <= most)) {
            fprintf(stderr, "fuzz: %.17g is not in [%g, %g]\n", out[i], least, most);
            fail("a number is not plausible");
        }
    }
}

/* Calls: each returns its status, after it has checked what was written */

static TranslucidAppearance appearance(void) {
    TranslucidAppearance all = {share(), 0.0, 0.0, cosine(), index_of_refraction(), configuration()};
    if (below(3) || rarely(20)) all.mfp = positive();
    if (all.mfp == 0.0 || rarely(20)) all.dmfp = positive();
    return all;
}

static TranslucidStatus profile_new(void) {
    TranslucidAppearance given = appearance();
    TranslucidStatus status = translucid_profile_new(model(), rarely(50) ? NULL : &given, (TranslucidProfile **)room_for_handle());
    return keep(PROFILE, status);
}
static TranslucidStatus profile_from_medium(void) {
    TranslucidMedium given = {positive(), positive(), cosine(), index_of_refraction(), configuration()};
    TranslucidStatus status =
        translucid_profile_from_medium(model(), rarely(50) ? NULL : &given, (TranslucidProfile **)room_for_handle());
    return keep(PROFILE, status);
}
static TranslucidStatus profile_from_samples(void) {
    size_t count = below(MOST);
    double *radii = rising(count), *reflectances = array(count, good_radius), *enclosed = rarely(4) ? rising(count) : NULL;
    for (size_t i = 0; i < count; i++) reflectances[i] = exp(-radii[i]) / (0.1 + radii[i]);
    TranslucidStatus status =
        translucid_profile_from_samples(rarely(50) ? NULL : radii, reflectances, enclosed, rarely(50) ? huge() : count,
                                        (TranslucidProfile **)room_for_handle());
    free(radii);
    free(reflectances);
    free(enclosed);
    return keep(PROFILE, status);
}
static TranslucidStatus profile_tabulated(void) {
    return keep(PROFILE, translucid_profile_tabulated(handle(PROFILE), (TranslucidProfile **)room_for_handle()));
}
static TranslucidStatus profile_total(void) {
    double total = SENTINEL;
    TranslucidStatus status = translucid_profile_total(handle(PROFILE), rarely(50) ? NULL : &total);
    check_output(status, &total, 1, 0.0, DBL_MAX);
    return status;
}

typedef TranslucidStatus Apply(const TranslucidProfile *, const double *, size_t, double *);
static TranslucidStatus apply(Apply *call, double (*good)(void), double most) {
    size_t count = below(MOST);
    double *x = numbers(count, good), *out = array(count, sentinel);
    int in_place = rarely(4);
    TranslucidStatus status = call(handle(PROFILE), rarely(50) ? NULL : x, rarely(50) ? huge() : count,
                                   in_place ? x : rarely(50) ? NULL : out);
    if (in_place && status == TRANSLUCID_STATUS_OK) check_output(status, x, count, 0.0, most);
    if (!in_place) check_output(status, out, count, 0.0, most);
    free(x);
    free(out);
    return status;
}
static TranslucidStatus profile_eval(void) { return apply(translucid_profile_eval, good_radius, DBL_MAX); }
static TranslucidStatus profile_pdf(void) { return apply(translucid_profile_pdf, good_radius, DBL_MAX); }
static TranslucidStatus profile_pdf_area(void) { return apply(translucid_profile_pdf_area, good_radius, DBL_MAX); }
static TranslucidStatus profile_cdf(void) { return apply(translucid_profile_cdf, good_radius, 1.0); }
static TranslucidStatus profile_enclosed(void) { return apply(translucid_profile_enclosed, good_radius, DBL_MAX); }
static TranslucidStatus profile_beyond(void) { return apply(translucid_profile_beyond, good_radius, DBL_MAX); }
static TranslucidStatus profile_quantile(void) { return apply(translucid_profile_quantile, good_share, DBL_MAX); }
static TranslucidStatus profile_sample(void) { return apply(translucid_profile_sample, good_share, DBL_MAX); }

static TranslucidStatus table_new(void) {
    TranslucidAppearance given = appearance();
    return keep(TABLE, translucid_table_new(model(), rarely(50) ? NULL : &given, (TranslucidTable **)room_for_handle()));
}
static TranslucidStatus table_from_samples(void) {
    size_t rows = 1 + below(3), count = 4 + below(12), all = rows * count;
    double *albedos = array(rows, good_share), *radii = rising(count), *reflectances = array(all, good_share);
    for (size_t i = 0; i < rows; i++) albedos[i] = rarely(30) ? strange() : (double)(i + 1) / 4.0;
    for (size_t i = 0; i < all; i++) reflectances[i] = rarely(300) ? strange() : exp(-(1.0 + (double)(i / count)) * radii[i % count]);
    TranslucidStatus status = translucid_table_from_samples(
        albedos, rarely(50) ? huge() : rows, rarely(50) ? NULL : radii, rarely(50) ? huge() : count, reflectances,
        rarely(10) ? reflectances : NULL, (TranslucidTable **)room_for_handle());
    free(albedos);
    free(radii);
    free(reflectances);
    return keep(TABLE, status);
}

static char path[3][4096];
static const char *file(size_t which) { return rarely(10) ? wrong_text() : rarely(20) ? NULL : path[which]; }

static TranslucidStatus table_load(void) {
    return keep(TABLE, translucid_table_load(file(rarely(5) ? 2 : 0), (TranslucidTable **)room_for_handle()));
}
static TranslucidStatus table_profile(void) {
    return keep(PROFILE, translucid_table_profile(handle(TABLE), share(), positive(), (TranslucidProfile **)room_for_handle()));
}

typedef TranslucidStatus TableApply(const TranslucidTable *, const double *, const double *, const double *, size_t, double *);
static TranslucidStatus table_apply(TableApply *call, double (*good)(void)) {
    size_t count = below(MOST);
    double *albedos = numbers(count, good_share), *lengths = numbers(count, good_radius), *x = numbers(count, good);
    double *out = array(count, sentinel);
    TranslucidStatus status = call(handle(TABLE), rarely(50) ? NULL : albedos, lengths, x, rarely(50) ? huge() : count,
                                   rarely(50) ? NULL : out);
    check_output(status, out, count, 0.0, DBL_MAX);
    free(albedos);
    free(lengths);
    free(x);
    free(out);
    return status;
}
static TranslucidStatus table_eval(void) { return table_apply(translucid_table_eval, good_radius); }
static TranslucidStatus table_pdf(void) { return table_apply(translucid_table_pdf, good_radius); }
static TranslucidStatus table_sample(void) { return table_apply(translucid_table_sample, good_share); }

static size_t threads(void) { return rarely(20) ? 2000 : 1 + below(2); }

static TranslucidStatus exact_new(void) {
    TranslucidHalfSpace given = {0.0, 0.0, rarely(2) ? positive() : 0.0, 0.0, configuration(), 0.0, threads()};
    if (below(2)) given.surface_albedo = share();
    else given.single_scattering_albedo = share();
    if (rarely(10)) given.surface_albedo = strange();
    /* A boundary and a tilted beam take long */
    if (rarely(40)) given.eta = index_of_refraction();
    if (rarely(40)) given.incidence_angle = rarely(4) ? strange() : 80.0 * uniform();
    return keep(EXACT, translucid_exact_new(rarely(50) ? NULL : &given, (TranslucidExact **)room_for_handle()));
}

static TranslucidStatus exact_figures(int which) {
    size_t count = below(4);
    double *r = numbers(count, good_radius), *azimuths = which == 0 && rarely(8) ? numbers(count, good_share) : NULL;
    double *value = array(count, sentinel), *error = rarely(4) ? NULL : array(count, sentinel);
    const TranslucidExact *exact = handle(EXACT);
    size_t n = rarely(50) ? huge() : count;
    double *out = rarely(50) ? NULL : value;
    TranslucidStatus status = which == 0   ? translucid_exact_eval(exact, r, azimuths, n, out, error)
                              : which == 1 ? translucid_exact_enclosed(exact, r, n, out, error)
                                           : translucid_exact_beyond(exact, r, n, out, error);
    check_output(status, value, count, 0.0, which == 0 ? DBL_MAX : 1.0);
    if (error) check_output(status, error, count, 0.0, DBL_MAX);
    free(r);
    free(azimuths);
    free(value);
    free(error);
    return status;
}
static TranslucidStatus exact_eval(void) { return exact_figures(0); }
static TranslucidStatus exact_enclosed(void) { return exact_figures(1); }
static TranslucidStatus exact_beyond(void) { return exact_figures(2); }
static TranslucidStatus exact_total(void) {
    double value = SENTINEL, error = SENTINEL;
    TranslucidStatus status = translucid_exact_total(handle(EXACT), rarely(50) ? NULL : &value, &error);
    check_output(status, &value, 1, 0.0, 1.0);
    check_output(status, &error, 1, 0.0, DBL_MAX);
    return status;
}

static TranslucidStatus white_new(void) {
    size_t count = below(9);
    double *radii = rising(count);
    TranslucidWalk given = {0};
    given.g = cosine();
    given.phase_function = rarely(3) ? one_of("moments:0.1,0.05", "rayleigh") : NULL;
    given.eta = index_of_refraction();
    given.thickness = rarely(3) ? positive() : 0.0;
    given.spot_radius = rarely(10) ? strange() : 0.0;
    given.configuration = configuration();
    given.incidence_angle = rarely(4) ? (rarely(4) ? strange() : 80.0 * uniform()) : 0.0;
    given.reference_albedo = rarely(10) ? strange() : 0.5 + 0.45 * uniform();
    if (below(2)) given.radii = radii, given.radius_count = rarely(30) ? huge() : count;
    else given.edges = rarely(30) ? NULL : radii, given.edge_count = count;
    given.sectors = rarely(4) ? (uint32_t)below(8) : rarely(20) ? UINT32_MAX : 0;
    TranslucidStatus status = translucid_white_table_new(rarely(50) ? NULL : &given, (TranslucidWhiteTable **)room_for_handle());
    free(radii);
    return keep(WHITE, status);
}

static int stop(uint64_t done, uint64_t total, void *user) {
    if (done > total || user != slots) fail("progress is told nonsense");
    return 1;
}
static int go_on(uint64_t done, uint64_t total, void *user) { return stop(done, total, user) - 1; }
static uint64_t photon_count(void) { return rarely(20) ? 0 : rarely(6) ? 20000 : 1 + below(200); }

static TranslucidStatus white_run(void) {
    if (rarely(100)) { /* Long, but stopped */
        return translucid_white_table_run(handle(WHITE), below(3), UINT64_MAX - below(3), 2, stop, slots);
    }
    return translucid_white_table_run(handle(WHITE), below(3), photon_count(), threads(), rarely(2) ? NULL : go_on, slots);
}
static TranslucidStatus white_run_range(void) {
    uint64_t start = rarely(10) ? UINT64_MAX - below(2) : below(1u << 30), end = start + photon_count();
    return translucid_white_table_run_range(handle(WHITE), below(3), start, end, threads(), go_on, slots);
}
static TranslucidStatus white_merge(void) {
    TranslucidWhiteTable *table = handle(WHITE);
    return translucid_white_table_merge(table, handle(WHITE));
}
static TranslucidStatus white_save(void) {
    /* Not what may be a file's name: it would be written */
    const char *target = rarely(4) ? "/nowhere/at/all.npz" : rarely(10) ? "\xff" : rarely(20) ? NULL : path[1];
    return translucid_white_table_save(handle(WHITE), target);
}
static TranslucidStatus white_load(void) {
    return keep(WHITE, translucid_white_table_load(file(rarely(3) ? 0 : 1), (TranslucidWhiteTable **)room_for_handle()));
}
static TranslucidStatus white_photons(void) {
    uint64_t photons = 0;
    return translucid_white_table_photons(handle(WHITE), rarely(50) ? NULL : &photons);
}
static TranslucidStatus white_edges(void) {
    size_t count = below(MOST), total = SIZE_MAX;
    double *edges = array(count, sentinel);
    TranslucidStatus status = translucid_white_table_edges(handle(WHITE), edges, rarely(50) ? huge() : count, &total);
    check_output(status, edges, status == TRANSLUCID_STATUS_OK && total < count ? total : count, 0.0, DBL_MAX);
    free(edges);
    return status;
}
static TranslucidStatus white_albedo(void) {
    double value = SENTINEL, error = SENTINEL;
    TranslucidStatus status = translucid_white_table_single_scattering_albedo(handle(WHITE), share(), &value, &error);
    check_output(status, &value, 1, 0.0, 1.0);
    check_output(status, &error, 1, 0.0, DBL_MAX);
    return status;
}

static TranslucidStatus white_figures(int which) {
    const TranslucidWhiteTable *table = handle(WHITE);
    double edges[MOST];
    size_t known = 0, count = below(3);
    double *r = numbers(count, good_radius);
    if (translucid_white_table_edges(table, edges, MOST, &known) == TRANSLUCID_STATUS_OK && known > 0) {
        known = known < MOST ? known : MOST;
        for (size_t i = 0; i < count; i++) r[i] = rarely(10) ? r[i] : edges[which < 2 ? (1 + 3 * below(known)) % known : below(known)];
    }
    double *value = array(count, sentinel), *error = rarely(4) ? NULL : array(count, sentinel);
    double albedo = 0.5 * share();
    size_t n = rarely(50) ? huge() : count;
    TranslucidStatus status =
        which == 0   ? translucid_white_table_eval(table, albedo, side(), r, n, value, error)
        : which == 1 ? translucid_white_table_eval_at_azimuth(table, albedo, side(), strange(), r, n, value, error)
        : which == 2 ? translucid_white_table_enclosed(table, albedo, side(), r, n, value, error)
                     : translucid_white_table_rings(table, albedo, side(), n, value, error);
    check_output(status, value, count, 0.0, DBL_MAX);
    if (error) check_output(status, error, count, 0.0, DBL_MAX);
    free(r);
    free(value);
    free(error);
    return status;
}
static TranslucidStatus white_eval(void) { return white_figures(0); }
static TranslucidStatus white_eval_at_azimuth(void) { return white_figures(1); }
static TranslucidStatus white_enclosed(void) { return white_figures(2); }
static TranslucidStatus white_rings(void) { return white_figures(3); }
static TranslucidStatus white_total(void) {
    double value = SENTINEL, error = SENTINEL;
    TranslucidStatus status = translucid_white_table_total(handle(WHITE), 0.5 * share(), side(), &value, &error);
    check_output(status, &value, 1, 0.0, 1.0);
    check_output(status, &error, 1, 0.0, DBL_MAX);
    return status;
}
static TranslucidStatus white_profile(void) {
    return keep(PROFILE, translucid_white_table_profile(handle(WHITE), 0.5 * share(), side(), (TranslucidProfile **)room_for_handle()));
}

static TranslucidStatus convert(void) {
    static const char *parameters[][2] = {{"renderman", "dmfp"}, {"arnold", "subsurface_radius"}, {"cycles-burley", "Radius"},
                                          {"hdrp", "scatteringDistance"}, {"pbrt", "mfp"}, {"translucid", "mfp"}};
    const char **known = parameters[below(6)];
    TranslucidSetting from = {known[0], known[1], {positive(), positive(), positive()}, rarely(3) ? 1 : 3};
    if (rarely(20)) from.system = wrong_text();
    if (rarely(20)) from.parameter = rarely(2) ? NULL : wrong_text();
    if (rarely(20)) from.count = rarely(2) ? huge() : below(5);
    const char *to[2] = {rarely(10) ? NULL : translucid_system_name(below(12)), "unreal"};
    TranslucidConversion given = {0};
    given.from = rarely(50) ? NULL : &from;
    given.from_count = rarely(50) ? huge() : 1;
    for (int i = 0; i < 3; i++) given.surface_albedo[i] = share();
    given.surface_albedo_count = rarely(20) ? below(6) : rarely(2) ? 1 : 3;
    given.unit = rarely(3) ? one_of("cm", "m") : NULL;
    given.to_unit = rarely(3) ? one_of("mm", "m") : NULL;
    given.to = to;
    given.to_count = rarely(20) ? 0 : 1 + below(2); /* All of them take long */
    given.set = &from;
    given.set_count = rarely(20);
    given.configuration = configuration();
    return keep(CONVERTED, translucid_convert(rarely(50) ? NULL : &given, (TranslucidConverted **)room_for_handle()));
}
static TranslucidStatus converted_read(void) {
    const TranslucidConverted *converted = handle(CONVERTED);
    size_t numbers = 0, notes = 0;
    TranslucidStatus status = translucid_converted_count(converted, &numbers, rarely(50) ? NULL : &notes);
    if (status != TRANSLUCID_STATUS_OK) return status;
    TranslucidConvertedNumber number;
    const char *note = NULL;
    size_t index = below(numbers + notes + 2);
    if (translucid_converted_note(converted, index, &note) == TRANSLUCID_STATUS_OK && strlen(note) == 0) fail("a note is empty");
    status = translucid_converted_number(converted, rarely(50) ? SIZE_MAX : index, &number);
    if (status == TRANSLUCID_STATUS_OK) {
        check_output(status, &number.value, 1, -DBL_MAX, DBL_MAX);
        if (strlen(number.system) == 0 || strlen(number.parameter) == 0 || strlen(number.source) == 0) fail("a name is empty");
    }
    return status;
}
static TranslucidStatus preset(void) {
    TranslucidPreset found = {{SENTINEL}, {SENTINEL}, SENTINEL, SENTINEL};
    TranslucidStatus status = translucid_preset(rarely(4) ? wrong_text() : translucid_preset_name(below(60)), &found);
    check_output(status, found.surface_albedo, 1, 0.0, 1.0);
    check_output(status, &found.eta, 1, 1.0, 3.0);
    return status;
}
static TranslucidStatus free_one(void) {
    Kind kind = (Kind)below(KINDS);
    if (rarely(3)) { /* By the function of another type, or of no handle */
        void *other = rarely(2) ? nothing : slots[(kind + 1) % KINDS][below(SLOTS)];
        return free_handle(kind, other);
    }
    void **slot = &slots[kind][below(SLOTS)];
    void *freed = *slot;
    *slot = NULL;
    return free_handle(kind, freed);
}

/* Every function with how often it is called, next to the others */
#define CALL(function, weight) {#function, function, weight, 0, 0}
static struct {
    const char *name;
    TranslucidStatus (*call)(void);
    unsigned weight, ok, refused;
} calls[] = {
    CALL(profile_new, 300), CALL(profile_from_medium, 100), CALL(profile_from_samples, 60), CALL(profile_tabulated, 10),
    CALL(profile_total, 300), CALL(profile_eval, 900), CALL(profile_pdf, 900), CALL(profile_pdf_area, 900),
    CALL(profile_cdf, 900), CALL(profile_enclosed, 900), CALL(profile_beyond, 900), CALL(profile_quantile, 300),
    CALL(profile_sample, 300), CALL(table_new, 1), CALL(table_from_samples, 10), CALL(table_load, 3),
    CALL(table_profile, 100), CALL(table_eval, 500), CALL(table_pdf, 500), CALL(table_sample, 500), CALL(exact_new, 2),
    CALL(exact_eval, 10), CALL(exact_enclosed, 10), CALL(exact_beyond, 10), CALL(exact_total, 100), CALL(white_new, 60),
    CALL(white_run, 3), CALL(white_run_range, 3), CALL(white_merge, 10), CALL(white_save, 3), CALL(white_load, 4),
    CALL(white_photons, 200), CALL(white_edges, 200), CALL(white_albedo, 4), CALL(white_eval, 30),
    CALL(white_eval_at_azimuth, 30), CALL(white_enclosed, 30), CALL(white_rings, 30), CALL(white_total, 30),
    CALL(white_profile, 20), CALL(convert, 10), CALL(converted_read, 600), CALL(preset, 20), CALL(free_one, 200),
};
enum { CALLS = sizeof calls / sizeof *calls };

static void check_status(TranslucidStatus status) {
    switch (status) {
    case TRANSLUCID_STATUS_OK: return;
    case TRANSLUCID_STATUS_NULL_POINTER:
    case TRANSLUCID_STATUS_WRONG_HANDLE:
    case TRANSLUCID_STATUS_INVALID_ARGUMENT:
    case TRANSLUCID_STATUS_FILE_ERROR:
    case TRANSLUCID_STATUS_STOPPED:
        if (strlen(translucid_last_error()) == 0) fail("a failure without a message");
        return;
    default: fail("a status that no argument explains");
    }
}

int main(int argc, char **argv) {
    if (argc != 3) return 2;
    unsigned long long wanted = strtoull(argv[1], NULL, 10);
    const char *names[3] = {"samples.csv", "table.npz", "nothing"};
    for (int i = 0; i < 3; i++) snprintf(path[i], sizeof path[i], "%s/%s", argv[2], names[i]);
    FILE *samples = fopen(path[0], "w");
    if (!samples) return 2;
    fputs("r,reflectance\n0.1,0.6\n0.3,0.14\n1,0.025\n3,0.0022\n10,0.00002\n", samples);
    fclose(samples);

    unsigned all = 0;
    for (int i = 0; i < CALLS; i++) all += calls[i].weight;
    for (unsigned long long done = 0; done < wanted; done++) {
        unsigned chosen = (unsigned)below(all);
        int i = 0;
        for (; chosen >= calls[i].weight; i++) chosen -= calls[i].weight;
        current = calls[i].name;
        TranslucidStatus status = calls[i].call();
        check_status(status);
        if (status == TRANSLUCID_STATUS_OK) calls[i].ok++;
        else calls[i].refused++;
    }

    unsigned ok = 0, refused = 0;
    int is_missing = 0;
    for (int i = 0; i < CALLS; i++) {
        ok += calls[i].ok;
        refused += calls[i].refused;
        if (wanted >= 100000 && (calls[i].ok == 0 || calls[i].refused == 0)) {
            fprintf(stderr, "fuzz: %s: %u worked, %u refused\n", calls[i].name, calls[i].ok, calls[i].refused);
            is_missing = 1;
        }
    }
    for (int kind = 0; kind < KINDS; kind++) {
        for (int i = 0; i < SLOTS; i++) free_handle((Kind)kind, slots[kind][i]);
    }
    printf("%u calls worked, %u were refused\n", ok, refused);
    return is_missing;
}
