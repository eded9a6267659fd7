#pragma once
// Light in a homogeneous slab by adding and doubling: an oracle for what scatters many times.
//
// Van de Hulst's method in the notation of Hansen and Travis 1974 and de Haan, Bosma and Hovenier
// 1987: R and T are matrices over the cosines of N directions a hemisphere (Gauss on 0…1, azimuths
// averaged, which is exact for fluxes) and of the incident light, which has no weight of its own. A
// layer so thin that light scatters once is doubled until it is the slab. Sharp lobes by δ-M
// (Wiscombe 1977): what 2 N moments can't tell from straight on goes straight on. All in double.

#include <cassert>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace skybark::support {

/// Shares of the flux that falls on the slab; what is missing to 1 is absorbed.
struct slab_fluxes {
    double transmission = 0; ///< all of it, straight on included
    double reflection = 0;
    double direct = 0; ///< e^{−τ/μ}
};

/// Gauss's nodes and weights on 0…1, by Newton from Chebyshev's guess.
struct half_range_gauss {
    std::vector<double> node, weight;
    explicit half_range_gauss(std::size_t n) : node(n), weight(n) {
        for (std::size_t i = 0; i < n; ++i) {
            double x = std::cos(3.141592653589793 * (double(i) + 0.75) / (double(n) + 0.5));
            double slope = 1;
            for (int turn = 0; turn < 100; ++turn) {
                double before = 1, p = x;
                for (std::size_t l = 2; l <= n; ++l) {
                    const double next =
                        ((2 * double(l) - 1) * x * p - (double(l) - 1) * before) / double(l);
                    before = std::exchange(p, next);
                }
                slope = double(n) * (x * p - before) / (x * x - 1);
                const double step = p / slope;
                x -= step;
                if (std::abs(step) < 1e-15) {
                    break;
                }
            }
            node[i] = (1 + x) / 2;
            weight[i] = 1 / ((1 - x * x) * slope * slope);
        }
    }
};

/// Henyey and Greenstein's moments: g^l.
[[nodiscard]] inline std::vector<double> henyey_greenstein_moments(double g, std::size_t count) {
    std::vector<double> out(count, 1);
    for (std::size_t l = 1; l < count; ++l) {
        out[l] = out[l - 1] * g;
    }
    return out;
}

/// A homogeneous slab of some matter, as thick as asked, lit by parallel light.
class slab_solver {
  public:
    /// Legendre's moments ∫ P P_l dω of the phase function, 2 · streams + 1 of them; the cosine of
    /// the incident light to the slab's normal, 0 < cosine ≤ 1.
    slab_solver(std::vector<double> moments, double albedo, double cosine = 1)
        : streams_((moments.size() - 1) / 2), size_(streams_ + 1), moments_(std::move(moments)),
          albedo_(albedo) {
        assert(moments_.size() % 2 == 1 && streams_ > 0);
        const half_range_gauss gauss(streams_);
        mu_ = gauss.node;
        mu_.push_back(cosine);
        weight_ = gauss.weight;
        weight_.push_back(0);
        const double straight = moments_.back();
        stretch_ = 1 - albedo * straight;
        scattered_ = albedo * (1 - straight) / stretch_;
        for (double& m : moments_) {
            m = (m - straight) / (1 - straight);
        }
        tabulate_phase();
    }

    [[nodiscard]] slab_fluxes fluxes(double depth) const {
        const layer slab = make(depth);
        slab_fluxes out;
        out.direct = std::exp(-depth / mu_[streams_]);
        out.transmission = slab.straight[streams_];
        for (std::size_t i = 0; i < streams_; ++i) {
            const double c = 2 * mu_[i] * weight_[i];
            out.transmission += c * slab.t[i * size_ + streams_];
            out.reflection += c * slab.r[i * size_ + streams_];
        }
        return out;
    }

    /// The fluence ∫ L dω, straight on included, below `above` of `depth`, over the irradiance of a
    /// surface that faces the light.
    [[nodiscard]] double fluence(double depth, double above) const {
        const layer top = make(above);
        const layer bottom = make(depth - above);
        const auto [down, up] = between(top, bottom);
        double sum = top.straight[streams_];
        for (std::size_t i = 0; i < streams_; ++i) {
            const std::size_t at = i * size_ + streams_;
            sum += 2 * mu_[streams_] * weight_[i] * (down[at] + up[at]);
        }
        return sum;
    }

  private:
    using matrix = std::vector<double>;
    struct layer {
        matrix r, t; ///< I(μ) = μ' F / π · R(μ, μ'), light that was scattered
        std::vector<double> straight;
    };

    /// ½ ∫ p dμ = 1 over −1…1: forwards_ p(μ, μ'), backwards_ p(−μ, μ').
    void tabulate_phase() {
        std::vector<double> legendre(size_ * 2 * streams_);
        for (std::size_t i = 0; i < size_; ++i) {
            double* p = &legendre[i * 2 * streams_];
            p[0] = 1;
            p[1] = mu_[i];
            for (std::size_t l = 2; l < 2 * streams_; ++l) {
                p[l] = ((2 * double(l) - 1) * mu_[i] * p[l - 1] - (double(l) - 1) * p[l - 2]) /
                       double(l);
            }
        }
        forwards_.assign(size_ * size_, 0);
        backwards_.assign(size_ * size_, 0);
        for (std::size_t i = 0; i < size_; ++i) {
            for (std::size_t j = 0; j < size_; ++j) {
                for (std::size_t l = 0; l < 2 * streams_; ++l) {
                    const double term = (2 * double(l) + 1) * moments_[l] *
                                        legendre[i * 2 * streams_ + l] *
                                        legendre[j * 2 * streams_ + l];
                    forwards_[i * size_ + j] += term;
                    backwards_[i * size_ + j] += l % 2 == 0 ? term : -term;
                }
            }
        }
    }

    [[nodiscard]] std::vector<double> straight_on(double depth) const {
        std::vector<double> out(size_);
        for (std::size_t i = 0; i < size_; ++i) {
            out[i] = std::exp(-depth / mu_[i]);
        }
        return out;
    }

    [[nodiscard]] layer thin(double depth) const {
        layer out{matrix(size_ * size_), matrix(size_ * size_), straight_on(depth)};
        for (std::size_t i = 0; i < size_; ++i) {
            const double m = mu_[i];
            for (std::size_t j = 0; j < size_; ++j) {
                const double n = mu_[j];
                const std::size_t at = i * size_ + j;
                out.r[at] = -scattered_ / (4 * (m + n)) * backwards_[at] *
                            std::expm1(-depth * (1 / m + 1 / n));
                const double through = std::abs(m - n) < 1e-12
                                           ? depth / (m * m)
                                           : std::expm1(-depth * (1 / m - 1 / n)) / (m - n);
                out.t[at] = scattered_ / 4 * forwards_[at] * through * std::exp(-depth / n);
            }
        }
        return out;
    }

    [[nodiscard]] layer make(double true_depth) const {
        double depth = true_depth * stretch_;
        int doublings = 0;
        for (; depth > 1e-10; depth /= 2) {
            ++doublings;
        }
        layer out = thin(depth);
        for (; doublings > 0; --doublings) {
            const auto [down, up] = between(out, out);
            depth *= 2;
            layer next{out.r, times(out.t, down), straight_on(depth)};
            const matrix again = times(out.t, up);
            for (std::size_t i = 0; i < size_; ++i) {
                for (std::size_t j = 0; j < size_; ++j) {
                    const std::size_t at = i * size_ + j;
                    next.r[at] += out.straight[i] * up[at] + again[at];
                    next.t[at] += out.straight[i] * down[at] + out.t[at] * out.straight[j];
                }
            }
            out = std::move(next);
        }
        return out;
    }

    /// What goes down and up between two layers, for light from above.
    [[nodiscard]] std::pair<matrix, matrix> between(const layer& top, const layer& bottom) const {
        const matrix once = times(top.r, bottom.r);
        const matrix echoes = resolve(once);
        matrix down = times(echoes, top.t);
        for (std::size_t i = 0; i < size_; ++i) {
            for (std::size_t j = 0; j < size_; ++j) {
                const std::size_t at = i * size_ + j;
                down[at] += top.t[at] + echoes[at] * top.straight[j];
            }
        }
        matrix up = times(bottom.r, down);
        for (std::size_t i = 0; i < size_; ++i) {
            for (std::size_t j = 0; j < size_; ++j) {
                up[i * size_ + j] += bottom.r[i * size_ + j] * top.straight[j];
            }
        }
        return {std::move(down), std::move(up)};
    }

    /// Σ 2 μ_k w_k A(i, k) B(k, j).
    [[nodiscard]] matrix times(const matrix& a, const matrix& b) const {
        matrix out(size_ * size_, 0);
        for (std::size_t i = 0; i < size_; ++i) {
            for (std::size_t k = 0; k < streams_; ++k) {
                const double factor = a[i * size_ + k] * 2 * mu_[k] * weight_[k];
                for (std::size_t j = 0; j < size_; ++j) {
                    out[i * size_ + j] += factor * b[k * size_ + j];
                }
            }
        }
        return out;
    }

    /// Q + Q·Q + Q·Q·Q + …, from S = Q + Q·S by elimination with pivots.
    [[nodiscard]] matrix resolve(const matrix& q) const {
        matrix left(size_ * size_);
        matrix right = q;
        for (std::size_t i = 0; i < size_; ++i) {
            for (std::size_t k = 0; k < size_; ++k) {
                left[i * size_ + k] = (i == k ? 1 : 0) - q[i * size_ + k] * 2 * mu_[k] * weight_[k];
            }
        }
        for (std::size_t c = 0; c < size_; ++c) {
            std::size_t pivot = c;
            for (std::size_t i = c + 1; i < size_; ++i) {
                if (std::abs(left[i * size_ + c]) > std::abs(left[pivot * size_ + c])) {
                    pivot = i;
                }
            }
            for (std::size_t j = 0; j < size_; ++j) {
                std::swap(left[c * size_ + j], left[pivot * size_ + j]);
                std::swap(right[c * size_ + j], right[pivot * size_ + j]);
            }
            const double over = 1 / left[c * size_ + c];
            for (std::size_t j = 0; j < size_; ++j) {
                left[c * size_ + j] *= over;
                right[c * size_ + j] *= over;
            }
            for (std::size_t i = 0; i < size_; ++i) {
                const double factor = left[i * size_ + c];
                if (i == c || factor == 0) {
                    continue;
                }
                for (std::size_t j = 0; j < size_; ++j) {
                    left[i * size_ + j] -= factor * left[c * size_ + j];
                    right[i * size_ + j] -= factor * right[c * size_ + j];
                }
            }
        }
        return right;
    }

    std::size_t streams_;
    std::size_t size_; ///< streams and, last, the incident light
    std::vector<double> moments_;
    std::vector<double> mu_, weight_;
    matrix forwards_, backwards_;
    double albedo_ = 0;
    double stretch_ = 1;   ///< δ-M: of the depth
    double scattered_ = 0; ///< δ-M: albedo
};

/// Fluxes of a slab with Henyey and Greenstein's phase function, to about 1e-6 for |g| ≤ 0.9.
[[nodiscard]] inline slab_fluxes adding_doubling(double depth, double g, double albedo,
                                                 double cosine = 1, std::size_t streams = 32) {
    return slab_solver(henyey_greenstein_moments(g, 2 * streams + 1), albedo, cosine).fluxes(depth);
}

} // namespace skybark::support
