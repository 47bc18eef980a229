// Importance samples the light that leaves a disk around the point where it entered, by a wrapper of forty lines.
//
//     c++ -std=c++17 disk.cpp $(pkg-config --cflags --libs translucid) -o disk && ./disk
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <translucid.h>
#include <vector>

namespace translucid {

inline void check(TranslucidStatus status) {
    if (status != TRANSLUCID_STATUS_OK) throw std::runtime_error(translucid_last_error());
}

/// A reflectance profile, owned; copies share it, as it never changes.
class Profile {
public:
    Profile(const std::string &model, const TranslucidAppearance &appearance) {
        TranslucidProfile *profile = nullptr;
        check(translucid_profile_new(model.c_str(), &appearance, &profile));
        own(profile);
    }

    /// The profile as a table, which is sampled in nanoseconds whatever the model.
    Profile tabulated() const {
        TranslucidProfile *table = nullptr;
        check(translucid_profile_tabulated(handle.get(), &table));
        return Profile(table);
    }

    std::vector<double> sample(std::vector<double> u) const { return apply(translucid_profile_sample, std::move(u)); }
    std::vector<double> eval(std::vector<double> r) const { return apply(translucid_profile_eval, std::move(r)); }
    std::vector<double> pdf_area(std::vector<double> r) const {
        return apply(translucid_profile_pdf_area, std::move(r));
    }
    double enclosed(double r) const { return apply(translucid_profile_enclosed, {r})[0]; }

private:
    using Call = decltype(&translucid_profile_eval);
    std::shared_ptr<TranslucidProfile> handle;

    explicit Profile(TranslucidProfile *profile) { own(profile); }
    void own(TranslucidProfile *profile) { handle = {profile, [](TranslucidProfile *p) { translucid_profile_free(p); }}; }
    std::vector<double> apply(Call call, std::vector<double> x) const {
        check(call(handle.get(), x.data(), x.size(), x.data()));
        return x;
    }
};

} // namespace translucid

int main() {
    constexpr int count = 100000;
    constexpr double pi = 3.14159265358979323846;
    TranslucidAppearance marble{};
    marble.surface_albedo = 0.9;
    marble.mfp = 0.4; // mm

    try {
        const auto profile = translucid::Profile("photon-beam-diffusion", marble).tabulated();

        // Draw points around the entry: a radius of the profile's density, and an angle
        std::mt19937_64 random(7);
        std::uniform_real_distribution<double> uniform;
        std::vector<double> u(count), angle(count);
        for (int i = 0; i < count; i++) {
            u[i] = uniform(random);
            angle[i] = 2.0 * pi * uniform(random);
        }
        const std::vector<double> r = profile.sample(u);
        const std::vector<double> reflectance = profile.eval(r), density = profile.pdf_area(r);

        // Light through half a disk of 1 mm: reflectance by density, where the point lies in it
        double sum = 0.0;
        for (int i = 0; i < count; i++) {
            const bool inside = r[i] < 1.0 && std::sin(angle[i]) > 0.0;
            sum += inside ? reflectance[i] / density[i] : 0.0;
        }
        const double estimate = sum / count, expected = 0.5 * profile.enclosed(1.0);
        // Standard deviation of the mean of numbers that are the surface albedo or 0
        const double deviation = std::sqrt(expected * (marble.surface_albedo - expected) / count);
        std::printf("half a disk of 1 mm: %.4f by samples, %.4f by the profile, %.4f standard deviation\n", estimate,
                    expected, deviation);
        if (std::abs(estimate - expected) > 4.0 * deviation) return 1;

        // A mistake is an exception with the library's message
        marble.surface_albedo = 1.2;
        translucid::Profile("photon-beam-diffusion", marble);
    } catch (const std::runtime_error &error) {
        std::printf("refused: %s\n", error.what());
        return marble.surface_albedo == 1.2 ? 0 : 2;
    }
    return 1;
}
