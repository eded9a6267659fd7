#pragma once
// Phase functions of clouds, on the host in double; `parameters()` is what a kernel carries and
// shared/phase.hpp evaluates.
//
//     auto droplets = clouds::phase_function::mie(10);                  // 10 µm across
//     kernel.phase = droplets->parameters();                            // shared::phase_value
//     auto light = clouds::light_of(*droplets);                         // attenuation_options
//     auto medium = clouds::medium_of(*droplets, albedo);               // multiple_scattering's
//
// All are normalised to 1 over the sphere and take the cosine of the scattering angle.

#include <skybark/core/result.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <glm/vec4.hpp>

namespace skybark::clouds {

/// (1 − weight) Henyey–Greenstein + weight Draine: how scattered light spreads over directions.
class phase_function {
  public:
    /// The same in every direction.
    constexpr phase_function() = default;
    [[nodiscard]] static constexpr phase_function isotropic() { return {}; }

    /// Henyey and Greenstein 1941. Its mean cosine is g, −1 < g < 1.
    [[nodiscard]] static phase_function henyey_greenstein(double g) { return {g, 0, 0, 0}; }

    /// Draine 2003. −1 < g < 1, alpha ≥ 0; Rayleigh's at g = 0, alpha = 1.
    [[nodiscard]] static phase_function draine(double g, double alpha) { return {0, g, alpha, 1}; }

    /// Any of them: −1 < g < 1, alpha ≥ 0, 0 ≤ weight ≤ 1.
    [[nodiscard]] static phase_function mixture(double g_henyey_greenstein, double g_draine,
                                                double alpha, double weight) {
        return {g_henyey_greenstein, g_draine, alpha, weight};
    }

    /// Water droplets `diameter_um` µm across, averaged over the visible: the fit to Mie's theory
    /// of Jendersie and d'Eon, "An Approximate Mie Scattering Function for Fog and Cloud
    /// Rendering", SIGGRAPH Talks 2023, equations 4–7. Clouds are often told by the radius:
    /// droplets of an effective radius of 10 µm are mie(20). Errors: bad_input outside of 5…50 µm.
    [[nodiscard]] static result<phase_function> mie(double diameter_um) {
        if (!(diameter_um >= 5 && diameter_um <= 50)) {
            return fail(
                error_code::bad_input,
                std::string("The fit to Mie's theory is for droplets 5 to 50 µm across, not ") +
                    std::to_string(diameter_um) + " µm.");
        }
        const double d = diameter_um;
        return phase_function{std::exp(-0.0990567 / (d - 1.67154)),
                              std::exp(-2.20679 / (d + 3.91029) - 0.428934),
                              std::exp(3.62489 - 8.29288 / (d + 5.52825)),
                              std::exp(-0.599085 / (d - 0.641583) - 0.665888)};
    }

    /// 1/sr at the cosine of the scattering angle.
    [[nodiscard]] double operator()(double cosine) const {
        return (1 - weight_) * henyey_greenstein_value(g_, cosine) +
               weight_ * henyey_greenstein_value(g_draine_, cosine) *
                   (1 + alpha_ * cosine * cosine) / draine_norm();
    }

    /// P(0): straight on, 1/sr.
    [[nodiscard]] double forward_value() const { return (*this)(1); }

    /// ∫ P u dω.
    [[nodiscard]] double mean_cosine() const {
        const double g = g_draine_;
        return (1 - weight_) * g_ +
               weight_ * g * (1 + alpha_ * (3 + 2 * g * g) / 5) / draine_norm();
    }

    /// ∫ P P₂(u) dω with Legendre's P₂: g² for Henyey–Greenstein. For Draine by
    /// u² P₂ = 2/15 + 11/21 P₂ + 12/35 P₄ and Henyey–Greenstein's moments g^l.
    [[nodiscard]] double second_moment() const {
        const double g2 = g_draine_ * g_draine_;
        return (1 - weight_) * g_ * g_ +
               weight_ * (g2 + alpha_ * (2.0 / 15 + 11.0 / 21 * g2 + 12.0 / 35 * g2 * g2)) /
                   draine_norm();
    }

    /// The fraction of energy that goes on as if it had not been scattered, 0 ≤ f < 1: the second
    /// moment (δ-Eddington, Joseph, Wiscombe and Weinman 1976). What scatters rather backwards than
    /// forwards has no such lobe: f is at most the mean cosine, and 0 below.
    [[nodiscard]] double forward_energy() const {
        return std::min(second_moment(), std::max(mean_cosine(), 0.0));
    }

    /// For a kernel: g of Henyey–Greenstein, g of Draine, alpha, weight of Draine.
    [[nodiscard]] glm::vec4 parameters() const {
        return {static_cast<float>(g_), static_cast<float>(g_draine_), static_cast<float>(alpha_),
                static_cast<float>(weight_)};
    }

    [[nodiscard]] double g_henyey_greenstein() const { return g_; }
    [[nodiscard]] double g_draine() const { return g_draine_; }
    [[nodiscard]] double alpha() const { return alpha_; }
    [[nodiscard]] double weight() const { return weight_; }

  private:
    phase_function(double g, double g_draine, double alpha, double weight)
        : g_(g), g_draine_(g_draine), alpha_(alpha), weight_(weight) {
        assert(g > -1 && g < 1 && g_draine > -1 && g_draine < 1);
        assert(alpha >= 0 && weight >= 0 && weight <= 1);
    }

    [[nodiscard]] static double henyey_greenstein_value(double g, double u) {
        constexpr double over_four_pi = 0.07957747154594767;
        const double s = (1 - g) * (1 - g) + 2 * g * (1 - u);
        return over_four_pi * (1 - g) * (1 + g) / (s * std::sqrt(s));
    }

    [[nodiscard]] double draine_norm() const {
        return 1 + alpha_ * (1 + 2 * g_draine_ * g_draine_) / 3;
    }

    double g_ = 0;
    double g_draine_ = 0;
    double alpha_ = 0;
    double weight_ = 0;
};

} // namespace skybark::clouds
