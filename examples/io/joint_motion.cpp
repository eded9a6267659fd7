#include <io/joint_motion.hpp>

#include <algorithm>
#include <cmath>
#include <glm/ext/quaternion_double.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <string>

namespace skybark::io {

namespace {

/// Where a joint is and how it is turned, in the world.
struct placement {
    glm::dvec3 position{0};
    glm::dquat rotation{1, 0, 0, 0};
};

glm::dquat unit(const glm::vec4& q) {
    return glm::normalize(glm::dquat(double{q.w}, double{q.x}, double{q.y}, double{q.z}));
}
glm::vec4 as_floats(const glm::dquat& q) { return glm::vec4(glm::dvec4(q.x, q.y, q.z, q.w)); }

bool is_finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
/// A rotation has to be a unit quaternion; this much off is still one that has been rounded often.
bool is_rotation(const glm::vec4& q) {
    const float l2 = glm::dot(q, q);
    return l2 > 0.98f && l2 < 1.02f;
}

placement rest_of(const joint& j) { return {glm::dvec3(j.base), unit(j.orientation)}; }

placement posed(const joint& j, const segment_pose& pose) {
    const glm::dquat turn = unit(pose.rotation);
    const glm::dvec3 from_base = glm::dvec3(j.base) - glm::dvec3(pose.base);
    return {glm::dvec3(pose.base) + glm::dvec3(pose.shift) + turn * from_base,
            glm::normalize(turn * unit(j.orientation))};
}

placement relative(const placement& parent, const placement& child) {
    const glm::dquat back = glm::conjugate(parent.rotation);
    return {back * (child.position - parent.position), glm::normalize(back * child.rotation)};
}

placement combined(const placement& parent, const placement& local) {
    return {parent.position + parent.rotation * local.position,
            glm::normalize(parent.rotation * local.rotation)};
}

/// What a reader finds of a local placement that was written as floats.
placement rounded(const placement& local) {
    return {glm::dvec3(glm::vec3(local.position)), unit(as_floats(local.rotation))};
}

/// The angle between two rotations, for what matters here: exact where it is small.
double angle_between(const glm::dquat& a, const glm::dquat& b) {
    const glm::dquat c = glm::conjugate(a) * b;
    return 2 * glm::length(glm::dvec3(c.x, c.y, c.z));
}

result<void> check(std::span<const joint> joints, std::span<const segment_pose> poses) {
    for (std::size_t i = 0; i < joints.size(); ++i) {
        if (joints[i].parent != trees::none && joints[i].parent >= i) {
            return fail(error_code::bad_input, "Joint " + std::to_string(i) +
                                                   " doesn't come after its parent, " +
                                                   std::to_string(joints[i].parent) + ".");
        }
        if (!is_finite(joints[i].base) || !is_rotation(joints[i].orientation)) {
            return fail(error_code::bad_input,
                        "Joint " + std::to_string(i) + " has no finite base and unit orientation.");
        }
    }
    if (joints.empty() ? !poses.empty() : poses.size() % joints.size() != 0) {
        return fail(error_code::bad_input, std::to_string(poses.size()) +
                                               " poses are no whole number of frames of " +
                                               std::to_string(joints.size()) + " joints.");
    }
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const segment_pose& p = poses[i];
        if (!is_finite(p.base) || !is_finite(p.shift) || !is_rotation(p.rotation)) {
            return fail(error_code::bad_input,
                        "The pose of segment " + std::to_string(i % joints.size()) + " in frame " +
                            std::to_string(i / joints.size()) + " isn't finite, or no rotation.");
        }
    }
    return {};
}

/// Walks the hierarchy, parents before children.
class motion_finder {
  public:
    motion_finder(std::span<const joint> joints, std::span<const segment_pose> poses)
        : joints_(joints), poses_(poses), world_(joints.size()), local_(joints.size()) {
        motion_.frames =
            static_cast<std::uint32_t>(joints.empty() ? 0 : poses.size() / joints.size());
    }

    joint_motion find() {
        find_rest();
        find_tracks();
        find_keys();
        return std::move(motion_);
    }

  private:
    [[nodiscard]] placement parent_of(std::size_t i, const std::vector<placement>& world) const {
        const std::uint32_t p = joints_[i].parent;
        return p == trees::none ? placement{} : world[p];
    }

    /// The rest as the file has it, in floats: what follows is taken against this.
    void find_rest() {
        for (std::size_t i = 0; i < joints_.size(); ++i) {
            const placement parent = parent_of(i, world_);
            local_[i] = rounded(relative(parent, rest_of(joints_[i])));
            world_[i] = combined(parent, local_[i]);
            motion_.rest_translation.emplace_back(local_[i].position);
            motion_.rest_rotation.push_back(as_floats(local_[i].rotation));
            glm::dmat4 inverse = glm::mat4_cast(glm::conjugate(world_[i].rotation));
            inverse[3] = glm::dvec4(glm::conjugate(world_[i].rotation) * -world_[i].position, 1);
            motion_.inverse_bind.emplace_back(inverse);
        }
    }

    /// How far joints turn and move against their parents, at most.
    void find_tracks() {
        std::vector<double> turn(joints_.size());
        std::vector<double> move(joints_.size());
        for (std::uint32_t frame = 0; frame < motion_.frames; ++frame) {
            for (std::size_t i = 0; i < joints_.size(); ++i) {
                world_[i] = posed(joints_[i], pose(frame, i));
                const placement local = relative(parent_of(i, world_), world_[i]);
                turn[i] = std::max(turn[i], angle_between(local_[i].rotation, local.rotation));
                move[i] = std::max(move[i], glm::distance(local_[i].position, local.position));
            }
        }
        constexpr double least = 1e-6; // of a radian, and of the extent
        motion_.rotation_track = tracks(turn, least);
        motion_.translation_track = tracks(move, least * extent());
    }

    /// Numbers the joints whose motion, with what was left out of the joints before them, matters.
    [[nodiscard]] std::vector<std::uint32_t> tracks(std::vector<double> left_out,
                                                    double least) const {
        std::vector<std::uint32_t> track(joints_.size(), joint_motion::still);
        std::uint32_t next = 0;
        for (std::size_t i = 0; i < joints_.size(); ++i) {
            if (joints_[i].parent != trees::none) {
                left_out[i] += left_out[joints_[i].parent];
            }
            if (left_out[i] > least) {
                track[i] = next++;
                left_out[i] = 0;
            }
        }
        return track;
    }

    [[nodiscard]] double extent() const {
        glm::dvec3 low(std::numeric_limits<double>::max());
        glm::dvec3 high = -low;
        for (const joint& j : joints_) {
            low = glm::min(low, glm::dvec3(j.base));
            high = glm::max(high, glm::dvec3(j.base));
        }
        return joints_.empty() ? 0 : glm::distance(low, high);
    }

    void find_keys() {
        motion_.rotations.resize(count(motion_.rotation_track) * motion_.frames);
        motion_.translations.resize(count(motion_.translation_track) * motion_.frames);
        for (std::uint32_t frame = 0; frame < motion_.frames; ++frame) {
            for (std::size_t i = 0; i < joints_.size(); ++i) {
                const placement parent = parent_of(i, world_);
                const placement wanted = relative(parent, posed(joints_[i], pose(frame, i)));
                world_[i] = combined(
                    parent, {translation_key(frame, i, wanted), rotation_key(frame, i, wanted)});
            }
        }
    }

    static std::size_t count(const std::vector<std::uint32_t>& track) {
        return track.size() - static_cast<std::size_t>(
                                  std::count(track.begin(), track.end(), joint_motion::still));
    }

    glm::dvec3 translation_key(std::uint32_t frame, std::size_t i, const placement& wanted) {
        const std::uint32_t track = motion_.translation_track[i];
        if (track == joint_motion::still) {
            return local_[i].position;
        }
        const glm::vec3 key(wanted.position);
        motion_.translations[std::size_t{track} * motion_.frames + frame] = key;
        return glm::dvec3(key);
    }

    glm::dquat rotation_key(std::uint32_t frame, std::size_t i, const placement& wanted) {
        const std::uint32_t track = motion_.rotation_track[i];
        if (track == joint_motion::still) {
            return local_[i].rotation;
        }
        glm::vec4 key = as_floats(wanted.rotation);
        glm::vec4* keys = motion_.rotations.data() + std::size_t{track} * motion_.frames;
        const glm::vec4 before = frame == 0 ? motion_.rest_rotation[i] : keys[frame - 1];
        key = glm::dot(before, key) < 0 ? -key : key;
        keys[frame] = key;
        return unit(key);
    }

    [[nodiscard]] const segment_pose& pose(std::uint32_t frame, std::size_t i) const {
        return poses_[std::size_t{frame} * joints_.size() + i];
    }

    std::span<const joint> joints_;
    std::span<const segment_pose> poses_;
    std::vector<placement> world_;
    std::vector<placement> local_; ///< at rest
    joint_motion motion_;
};

} // namespace

std::vector<joint> joints_of(const trees::skeleton& from) {
    std::vector<joint> joints(from.size());
    for (std::size_t i = 0; i < from.size(); ++i) {
        const glm::quat& q = from.orientation[i];
        joints[i] = {from.parent[i], from.position[i], {q.x, q.y, q.z, q.w}};
    }
    return joints;
}

result<joint_motion> find_motion(std::span<const joint> joints,
                                 std::span<const segment_pose> poses) {
    if (auto good = check(joints, poses); !good) {
        return failure(good.error());
    }
    return motion_finder(joints, poses).find();
}

} // namespace skybark::io
