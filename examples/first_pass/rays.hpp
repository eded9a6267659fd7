#pragma once
// Rays through surfaces, by Embree.

#include <first_pass/lights.hpp>

#include <memory>

namespace skybark::first_pass {

class rays {
  public:
    explicit rays(const surfaces& of);
    ~rays();
    rays(rays&&) noexcept;
    rays& operator=(rays&&) noexcept;

    /// What a ray from `origin` along `direction` (unit) meets first; holes let it pass.
    [[nodiscard]] gather_hit first_hit(glm::vec3 origin, glm::vec3 direction) const;
    /// Whether nothing lies along a ray, from its origin to origin + reach · direction.
    [[nodiscard]] bool is_clear(glm::vec3 origin, glm::vec3 direction, float reach) const;

    [[nodiscard]] glm::vec3 centre() const; ///< of the bounding box, m
    [[nodiscard]] float radius() const;     ///< half of its diagonal, m
    /// How far rays begin off their surface, along its normal, so that they don't meet it, m.
    [[nodiscard]] float lift() const;

  private:
    struct scene;
    std::unique_ptr<scene> scene_;
};

} // namespace skybark::first_pass
