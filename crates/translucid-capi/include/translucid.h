/* translucid.h: reflectance profiles for subsurface scattering, their tables, samples, references and conversion.
 *
 * Made by cbindgen of crates/translucid-capi; do not edit. SPDX-License-Identifier: MIT OR Apache-2.0
 *
 * Calls. A call returns a TranslucidStatus. Where that is not TRANSLUCID_STATUS_OK, translucid_last_error says what was
 * found and what is allowed, and nothing was written to the caller's memory. No call throws, prints or ends the
 * program; but a mistake of the library itself is told on stderr, too, and a program whose last memory is gone ends.
 *
 * Pointers. Handles, structures, texts and arrays belong to the caller and must stay as they are until the call has
 * ended; arrays have as many elements as the call says. NULL is refused where nothing else is said. out may be the very
 * array that is read, but not overlap it otherwise. Texts end with a 0 and are UTF-8; names are those of the command
 * and of the Python module.
 *
 * Handles. What a call makes is freed once by the function *_free of its type, and not used afterwards: handles that
 * were freed cannot be told from others.
 *
 * Threads. All functions may be called from any thread at any time, with the same handles; but a handle is freed when
 * no other thread uses it. The message of a failure belongs to the thread that met it. Calls start threads only where
 * they take a number of threads, and these end with the call.
 *
 * Numbers are finite wherever a call has worked. Random numbers are the caller's.
 */


#ifndef TRANSLUCID_H
#define TRANSLUCID_H

#include <stddef.h>
#include <stdint.h>

// Major version of the header.
#define TRANSLUCID_VERSION_MAJOR 0

// Minor version of the header.
#define TRANSLUCID_VERSION_MINOR 1

// Patch version of the header.
#define TRANSLUCID_VERSION_PATCH 0

// Outcome of a call.
typedef enum {
  // It has worked.
  TRANSLUCID_STATUS_OK = 0,
  // A pointer is NULL that must not be.
  TRANSLUCID_STATUS_NULL_POINTER = 1,
  // A handle is of another type, or no handle at all.
  TRANSLUCID_STATUS_WRONG_HANDLE = 2,
  // A number, a name, a length of an array or the content of a file is not what it must be.
  TRANSLUCID_STATUS_INVALID_ARGUMENT = 3,
  // A file cannot be read or written.
  TRANSLUCID_STATUS_FILE_ERROR = 4,
  // The progress function has stopped the work.
  TRANSLUCID_STATUS_STOPPED = 5,
  // Another thread is changing the handle.
  TRANSLUCID_STATUS_BUSY = 6,
  // There is not enough memory, or no thread can be started.
  TRANSLUCID_STATUS_OUT_OF_RESOURCES = 7,
  // A mistake of the library, which is to be reported.
  TRANSLUCID_STATUS_INTERNAL_ERROR = 8,
} TranslucidStatus;

// A material in the numbers of other systems.
//
// It never changes, so any number of threads may use it at once.
typedef struct TranslucidConverted TranslucidConverted;

// The exact solution of a half space of isotropic scatterers.
//
// It never changes, so any number of threads may use it at once.
typedef struct TranslucidExact TranslucidExact;

// A reflectance profile R(r): the light that leaves a flat surface at the distance r from the point where one unit of
// flux entered, per area.
//
// It never changes, so any number of threads may use it at once.
typedef struct TranslucidProfile TranslucidProfile;

// Profiles of all surface albedos as a table, which is evaluated and sampled in constant time.
//
// It never changes, so any number of threads may use it at once.
typedef struct TranslucidTable TranslucidTable;

// Photons that left a medium, counted over place and order of scattering: one walk, every albedo.
//
// Lengths are mean free paths. The table depends on its photons alone, not on threads or on the sequence in which parts
// of it were walked. Any number of threads may use it at once; while one walks or merges, others read the table as it
// was before, and are refused if they want to walk or merge, too.
typedef struct TranslucidWhiteTable TranslucidWhiteTable;

// A parameter of a system.
typedef struct {
  // One of translucid_system_name.
  const char *system;
  // The parameter's name in the system; case, spaces and underscores do not matter.
  const char *parameter;
  // One number, or three for red, green and blue.
  double values[3];
  // How many numbers, 1 or 3.
  size_t count;
} TranslucidSetting;

// A material in the numbers of one system, to be said in those of others. A field that is 0 or NULL has its default.
typedef struct {
  // Parameters of the system that the material comes from.
  const TranslucidSetting *from;
  // Number of those parameters.
  size_t from_count;
  // Surface albedo as one enters it in the source system, in [0, 1].
  double surface_albedo[3];
  // How many numbers, 1 or 3; 0 for a system whose coefficients determine it.
  size_t surface_albedo_count;
  // Unit of lengths in the scene that the material comes from, "mm", the default, "cm" or "m", for systems without a
  // unit of their own.
  const char *unit;
  // Unit of lengths in the scene that it goes to; by default the same.
  const char *to_unit;
  // Systems that it goes to; by default all.
  const char *const *to;
  // Number of those systems.
  size_t to_count;
  // Factors and distances of those systems that are to have a value.
  const TranslucidSetting *set;
  // Number of those.
  size_t set_count;
  // How light enters in the fit between the width of a profile and the mean free path: "searchlight", or "diffuse",
  // which is the default.
  const char *configuration;
} TranslucidConversion;

// A number of a material. Texts last as long as the TranslucidConverted that they come from.
typedef struct {
  // Name of the system.
  const char *system;
  // Name of the parameter in the system.
  const char *parameter;
  // "r", "g" or "b", or "all" for what is one for all.
  const char *channel;
  // Value of the parameter.
  double value;
  // Unit of the value; empty for numbers without one.
  const char *unit;
  // Quantity that is the same on both sides: "surface_albedo", "d", the profile's width, or "mfp".
  const char *equal;
  // The code or the document that the rule was read in.
  const char *source;
} TranslucidConvertedNumber;

// A half space of isotropic scatterers. A field that is 0 or NULL has its default.
typedef struct {
  // Share of the light that leaves again, in (0, 1]: this or the single-scattering albedo.
  double surface_albedo;
  // Share of a collision that is scattered, in (0, 1].
  double single_scattering_albedo;
  // Mean free path, in [1e-100, 1e100]; by default 1.
  double mfp;
  // Relative index of refraction, inside over outside, in [0.5, 3]; by default 1.
  double eta;
  // How light enters: "searchlight", or "diffuse", which is the default without an angle.
  const char *configuration;
  // Angle of a beam outside, in degrees from the normal, in [0, 90).
  double incidence_angle;
  // Number of threads, at most 1024; by default one per processor.
  size_t threads;
} TranslucidHalfSpace;

// A named translucent material, its numbers for red, green and blue.
typedef struct {
  // Surface albedo, in [0, 1].
  double surface_albedo[3];
  // Mean free path in millimeters.
  double mfp[3];
  // Index of refraction of the surface.
  double eta;
  // Perceptual roughness of the surface, by eye.
  double roughness;
} TranslucidPreset;

// Looks of a translucent material. A field that is 0 or NULL has its default.
typedef struct {
  // Surface albedo A, the share of the light that leaves again, in [0, 1].
  double surface_albedo;
  // Mean free path in the volume, greater than 0, in any unit of length: this or dmfp.
  double mfp;
  // Diffuse mean free path on the surface, greater than 0.
  double dmfp;
  // Mean cosine of the phase function, in (-1, 1); models without one take 0 only.
  double g;
  // Relative index of refraction, inside over outside; by default 1, and models without a boundary take 1 only.
  double eta;
  // How light enters: "searchlight", a pencil beam along the normal, or "diffuse", from all directions; by default
  // "diffuse" with an mfp and "searchlight" with a dmfp, the fits that renderers use.
  const char *configuration;
} TranslucidAppearance;

// A medium by its coefficients. A field that is 0 or NULL has its default.
typedef struct {
  // Absorption coefficient, at least 0, in the inverse of the unit of radii.
  double sigma_a;
  // Scattering coefficient, at least 0, likewise.
  double sigma_s;
  // Mean cosine of the phase function, in (-1, 1). Models that know isotropic scattering only get the similar
  // isotropic medium, of (1 - g) sigma_s.
  double g;
  // Relative index of refraction, inside over outside; by default 1, and models without a boundary take 1 only.
  double eta;
  // How light enters: "searchlight", or "diffuse", which is the default.
  const char *configuration;
} TranslucidMedium;

// Geometry, boundary, scattering and light of a walk, and where its photons are counted. A field that is 0 or NULL has
// its default.
typedef struct {
  // Mean cosine of the phase function, in (-1, 1).
  double g;
  // "henyey-greenstein", the default, or for g = 0 "rayleigh", "two-term:W,G1,G2" (parts W and 1 - W of two
  // Henyey-Greenstein functions) or "moments:X1,X2,..." (Legendre moments from the first on).
  const char *phase_function;
  // Relative index of refraction, inside over outside, in [0.1, 10]; by default 1.
  double eta;
  // Thickness of a slab; by default a half space.
  double thickness;
  // Radius of the disc over which light enters evenly.
  double spot_radius;
  // How light enters: "searchlight", or "diffuse", which is the default without an angle.
  const char *configuration;
  // Angle of a beam outside, in degrees from the normal, in [0, 90).
  double incidence_angle;
  // Single-scattering albedo of the walk, in (0, 0.999999], the highest that can be asked for; by default 0.999.
  double reference_albedo;
  // Radii at which R(r) is wanted, at most 8000: each gets a narrow ring inside and one outside.
  const double *radii;
  // Number of radii.
  size_t radius_count;
  // Radii between wide rings, rising, at most 8000, in place of radii.
  const double *edges;
  // Number of edges.
  size_t edge_count;
  // Sectors of a half circle into which rings are cut, for azimuths, at most 720; by default 1.
  uint32_t sectors;
} TranslucidWalk;

// Function that is told how many photons of a run are done, on the thread that called the run, some times a second.
//
// Another value than 0 stops the run. It must return: neither by longjmp nor by an exception may it leave.
typedef int (*TranslucidProgress)(uint64_t done, uint64_t total, void *user);

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Name of a system by its index: NULL behind the last.
//
// The text lasts as long as the program.
const char *translucid_system_name(size_t index);

// Converts a material.
TranslucidStatus translucid_convert(const TranslucidConversion *conversion, TranslucidConverted **converted);

// Frees what a conversion made. NULL is none.
TranslucidStatus translucid_converted_free(TranslucidConverted *converted);

// Gives how many numbers there are, system by system, the surface albedo first, and how many notes.
TranslucidStatus translucid_converted_count(const TranslucidConverted *converted,
                                            size_t *numbers,
                                            size_t *notes);

// Gives the number of an index.
TranslucidStatus translucid_converted_number(const TranslucidConverted *converted,
                                             size_t index,
                                             TranslucidConvertedNumber *number);

// Gives the note of an index: which system has no numbers, or will not use them as they are.
//
// The text lasts as long as the TranslucidConverted.
TranslucidStatus translucid_converted_note(const TranslucidConverted *converted,
                                           size_t index,
                                           const char **note);

// Solves a half space, which takes milliseconds, with a boundary 0.7 s of one processor.
TranslucidStatus translucid_exact_new(const TranslucidHalfSpace *half_space, TranslucidExact **exact);

// Frees a solution. NULL is none.
TranslucidStatus translucid_exact_free(TranslucidExact *exact);

// Gives R(r) per unit of flux that has entered for count radii, at least 0, and an estimate of its greatest numerical
// error, where it is not NULL.
//
// For a tilted beam azimuths are directions from the entry in degrees, from where the beam points to; where it is NULL,
// R is the mean over all.
TranslucidStatus translucid_exact_eval(const TranslucidExact *exact,
                                       const double *r,
                                       const double *azimuths,
                                       size_t count,
                                       double *value,
                                       double *error);

// Gives the energy that leaves within r, with the digits of a small r, and its error, where it is not NULL.
TranslucidStatus translucid_exact_enclosed(const TranslucidExact *exact,
                                           const double *r,
                                           size_t count,
                                           double *value,
                                           double *error);

// Gives the energy that leaves beyond r, with the digits of a large r, and its error, where it is not NULL.
TranslucidStatus translucid_exact_beyond(const TranslucidExact *exact,
                                         const double *r,
                                         size_t count,
                                         double *value,
                                         double *error);

// Gives the surface albedo, all the energy that leaves, and its error, where it is not NULL.
TranslucidStatus translucid_exact_total(const TranslucidExact *exact, double *value, double *error);

// Name of a preset by its index: NULL behind the last.
//
// The text lasts as long as the program.
const char *translucid_preset_name(size_t index);

// Gives the preset of a name; case, spaces and hyphens do not matter.
TranslucidStatus translucid_preset(const char *name, TranslucidPreset *preset);

// Name of a model by its index: NULL behind the last.
//
// The text lasts as long as the program.
const char *translucid_model_name(size_t index);

// Makes the profile of a model: one of translucid_model_name, by default "normalized-diffusion-refined".
TranslucidStatus translucid_profile_new(const char *model,
                                        const TranslucidAppearance *appearance,
                                        TranslucidProfile **profile);

// Makes the profile of a medium by a model, which is as in translucid_profile_new.
TranslucidStatus translucid_profile_from_medium(const char *model,
                                                const TranslucidMedium *medium,
                                                TranslucidProfile **profile);

// Makes the profile through count samples that somebody measured or simulated: at least four radii, greater than 0,
// rising, and R(r), at least 0, falling towards the end.
//
// Where the energies within the radii are known, they are kept; else enclosed is NULL.
TranslucidStatus translucid_profile_from_samples(const double *radii,
                                                 const double *reflectances,
                                                 const double *enclosed,
                                                 size_t count,
                                                 TranslucidProfile **profile);

// Makes a table of a profile, whose cdf, quantile and samples take some ten nanoseconds for every model; off by some
// 1e-5 of the cdf at most.
TranslucidStatus translucid_profile_tabulated(const TranslucidProfile *profile,
                                              TranslucidProfile **tabulated);

// Frees a profile. NULL is none.
TranslucidStatus translucid_profile_free(TranslucidProfile *profile);

// Gives the energy that leaves altogether, the surface albedo; where a model makes more than there is, greater than 1.
TranslucidStatus translucid_profile_total(const TranslucidProfile *profile,
                                          double *total);

// Gives R(r) for count radii, at least 0, in the inverse square of their unit; at r = 0 the greatest finite number.
TranslucidStatus translucid_profile_eval(const TranslucidProfile *profile,
                                         const double *r,
                                         size_t count,
                                         double *out);

// Gives the probability density per length of the radius at which light leaves, 2 pi r R(r) / A: that of samples.
TranslucidStatus translucid_profile_pdf(const TranslucidProfile *profile,
                                        const double *r,
                                        size_t count,
                                        double *out);

// Gives the probability density per area of the point at which light leaves, R(r) / A.
TranslucidStatus translucid_profile_pdf_area(const TranslucidProfile *profile,
                                             const double *r,
                                             size_t count,
                                             double *out);

// Gives the share of the light that leaves within r, in [0, 1].
TranslucidStatus translucid_profile_cdf(const TranslucidProfile *profile,
                                        const double *r,
                                        size_t count,
                                        double *out);

// Gives the energy that leaves within r, which rises to the total.
TranslucidStatus translucid_profile_enclosed(const TranslucidProfile *profile,
                                             const double *r,
                                             size_t count,
                                             double *out);

// Gives the energy that leaves beyond r, with the digits of a large r.
TranslucidStatus translucid_profile_beyond(const TranslucidProfile *profile,
                                           const double *r,
                                           size_t count,
                                           double *out);

// Gives the radius within which the share u of the light leaves, u in [0, 1]: the inverse of the cdf.
TranslucidStatus translucid_profile_quantile(const TranslucidProfile *profile,
                                             const double *u,
                                             size_t count,
                                             double *out);

// Gives a radius of the density pdf for each random number u, uniform on [0, 1).
//
// It need not rise with u. Models without a closed form search: sample a table of them where there are more than some
// dozens.
TranslucidStatus translucid_profile_sample(const TranslucidProfile *profile,
                                           const double *u,
                                           size_t count,
                                           double *out);

// Message of the last call on this thread that failed, in English and UTF-8; empty if none has.
//
// It belongs to the library and is valid until another call on the same thread fails.
const char *translucid_last_error(void);

// Makes the table of a model, which is as in translucid_profile_new.
//
// The appearance counts but for its surface albedo and the length: where mfp is not 0, lengths of the table's
// profiles are mean free paths, and where dmfp is not 0 diffuse ones. Between albedos the cdf is off by less than
// 3e-4; the most that the model reaches stands in for albedos above it.
TranslucidStatus translucid_table_new(const char *model,
                                      const TranslucidAppearance *appearance,
                                      TranslucidTable **table);

// Makes a table of samples: a row of reflectances at the same radii for each of the surface albedos, which rise.
//
// Radii are multiples of the profiles' length, at least four, greater than 0, rising. The rows lie one after the other;
// so do energies within the radii where they are known, else enclosed is NULL. Of the rows only the shape counts.
TranslucidStatus translucid_table_from_samples(const double *surface_albedos,
                                               size_t row_count,
                                               const double *radii,
                                               size_t radius_count,
                                               const double *reflectances,
                                               const double *enclosed,
                                               TranslucidTable **table);

// Makes a table of a CSV file with the columns r and reflectance, optionally enclosed and surface_albedo, such as
// "translucid reference" prints.
TranslucidStatus translucid_table_load(const char *path,
                                       TranslucidTable **table);

// Frees a table; profiles made of it stay. NULL is none.
TranslucidStatus translucid_table_free(TranslucidTable *table);

// Makes the profile of a surface albedo in [0, 1] and a length in [1e-150, 1e150].
TranslucidStatus translucid_table_profile(const TranslucidTable *table,
                                          double surface_albedo,
                                          double length,
                                          TranslucidProfile **profile);

// Gives R(r), each for a surface albedo, a length and a radius of its own.
TranslucidStatus translucid_table_eval(const TranslucidTable *table,
                                       const double *surface_albedos,
                                       const double *lengths,
                                       const double *r,
                                       size_t count,
                                       double *out);

// Gives the probability density of radii per length, each for a surface albedo, a length and a radius of its own.
TranslucidStatus translucid_table_pdf(const TranslucidTable *table,
                                      const double *surface_albedos,
                                      const double *lengths,
                                      const double *r,
                                      size_t count,
                                      double *out);

// Gives a radius of that density, each for a surface albedo, a length and a random number u of its own, uniform on
// [0, 1).
TranslucidStatus translucid_table_sample(const TranslucidTable *table,
                                         const double *surface_albedos,
                                         const double *lengths,
                                         const double *u,
                                         size_t count,
                                         double *out);

// Version of the library that runs, such as "0.1.0".
const char *translucid_version(void);

// Makes an empty table.
TranslucidStatus translucid_white_table_new(const TranslucidWalk *walk, TranslucidWhiteTable **table);

// Reads a table from an NPZ file that translucid_white_table_save, the command or the Python module has written.
TranslucidStatus translucid_white_table_load(const char *path,
                                             TranslucidWhiteTable **table);

// Writes the table to an NPZ file, which is replaced whole or not at all.
TranslucidStatus translucid_white_table_save(const TranslucidWhiteTable *table, const char *path);

// Frees a table; profiles made of it stay. NULL is none.
TranslucidStatus translucid_white_table_free(TranslucidWhiteTable *table);

// Walks photons more of a seed, the first that the table does not hold, on a number of threads, at most 1024: by 0 one
// per processor.
//
// progress may be NULL, and user is passed on to it. Where it stops the run, the table holds the photons that were
// done, and the status is TRANSLUCID_STATUS_STOPPED.
TranslucidStatus translucid_white_table_run(TranslucidWhiteTable *table,
                                            uint64_t seed,
                                            uint64_t photons,
                                            size_t threads,
                                            TranslucidProgress progress,
                                            void *user);

// Walks the photons of a seed from start to before end, as one of many machines does that share the work; otherwise as
// translucid_white_table_run.
TranslucidStatus translucid_white_table_run_range(TranslucidWhiteTable *table,
                                                  uint64_t seed,
                                                  uint64_t start,
                                                  uint64_t end,
                                                  size_t threads,
                                                  TranslucidProgress progress,
                                                  void *user);

// Adds the photons of another table of the same walk, exactly; it must have other photons.
TranslucidStatus translucid_white_table_merge(TranslucidWhiteTable *table, const TranslucidWhiteTable *other);

// Gives the number of photons that entered the medium.
TranslucidStatus translucid_white_table_photons(const TranslucidWhiteTable *table, uint64_t *photons);

// Gives the radii between the table's rings, and their number: as many as fit in count, all of them if edges is NULL
// and count 0 tells the number alone.
TranslucidStatus translucid_white_table_edges(const TranslucidWhiteTable *table,
                                              double *edges,
                                              size_t count,
                                              size_t *total);

// Gives the single-scattering albedo at which the face of entry returns a surface albedo, and its standard error where
// that is not NULL.
//
// Where the exact solution knows it, it is that one, without an error.
TranslucidStatus translucid_white_table_single_scattering_albedo(const TranslucidWhiteTable *table,
                                                                 double surface_albedo,
                                                                 double *value,
                                                                 double *error);

// Gives R(r), or the transmittance per area, at count radii of the walk, and standard errors where those are not NULL.
//
// The albedo goes up to the one of the walk; side is the face of a slab at which light leaves: "reflected",
// the default for NULL, or "transmitted".
TranslucidStatus translucid_white_table_eval(const TranslucidWhiteTable *table,
                                             double single_scattering_albedo,
                                             const char *side,
                                             const double *r,
                                             size_t count,
                                             double *value,
                                             double *error);

// Gives R(r) as translucid_white_table_eval does, of the sector that holds an azimuth: a direction from the entry in
// degrees, from where a tilted beam points to.
TranslucidStatus translucid_white_table_eval_at_azimuth(const TranslucidWhiteTable *table,
                                                        double single_scattering_albedo,
                                                        const char *side,
                                                        double azimuth,
                                                        const double *r,
                                                        size_t count,
                                                        double *value,
                                                        double *error);

// Gives the energy that leaves within count radii, each one between rings of the table, and standard errors where those
// are not NULL.
TranslucidStatus translucid_white_table_enclosed(const TranslucidWhiteTable *table,
                                                 double single_scattering_albedo,
                                                 const char *side,
                                                 const double *r,
                                                 size_t count,
                                                 double *value,
                                                 double *error);

// Gives the energy that leaves through a face, for the one of entry the surface albedo, and its standard error where
// that is not NULL.
TranslucidStatus translucid_white_table_total(const TranslucidWhiteTable *table,
                                              double single_scattering_albedo,
                                              const char *side,
                                              double *value,
                                              double *error);

// Gives the mean reflectances over the first count rings, the first from the center to the first radius, and standard
// errors where those are not NULL.
//
// There are as many as radii between rings: light beyond the last is not among them.
TranslucidStatus translucid_white_table_rings(const TranslucidWhiteTable *table,
                                              double single_scattering_albedo,
                                              const char *side,
                                              size_t count,
                                              double *value,
                                              double *error);

// Makes the profile through the energies within the table's radii, to evaluate and to sample; radii are mean free paths.
//
// Choose edges such that rings are filled well: their noise is the profile's.
TranslucidStatus translucid_white_table_profile(const TranslucidWhiteTable *table,
                                                double single_scattering_albedo,
                                                const char *side,
                                                TranslucidProfile **profile);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* TRANSLUCID_H */
