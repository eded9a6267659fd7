// Ends carried by the poses of segments: at rest, moved as one body, and bent at every joint.

#include "support/devices.hpp"
#include "support/test_trees.hpp"

#include <skybark/trees/branch_mesh.hpp>

#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/random.hpp>

using namespace skybark;

namespace {

std::vector<segment_pose> poses_at_rest(const trees::skeleton& of) {
    std::vector<segment_pose> poses(of.size());
    for (std::size_t i = 0; i < of.size(); ++i) {
        poses[i].base = of.position[i];
    }
    return poses;
}

struct moved {
    glm::dquat turn;
    glm::dvec3 shift;
    [[nodiscard]] glm::dvec3 operator()(const glm::dvec3& x) const { return turn * x + shift; }
};

/// All segments as one body.
std::vector<segment_pose> poses_of_body(const trees::skeleton& of, const moved& body) {
    auto poses = poses_at_rest(of);
    for (segment_pose& p : poses) {
        const glm::dquat& q = body.turn;
        p.rotation = glm::vec4(q.x, q.y, q.z, q.w);
        p.shift = glm::vec3(body(glm::dvec3(p.base)) - glm::dvec3(p.base));
    }
    return poses;
}

/// Every joint turned by its own rotation vector of at most `most` rad, from the root outwards.
std::vector<segment_pose> poses_bent(const trees::skeleton& of, double most) {
    support::random_source random(5);
    std::vector<glm::dquat> turn(of.size());
    std::vector<glm::dvec3> base(of.size());
    auto poses = poses_at_rest(of);
    for (std::size_t i = 0; i < of.size(); ++i) {
        const glm::dquat own = glm::angleAxis(random.between(0, most), random.direction());
        const std::uint32_t p = of.parent[i];
        const glm::dvec3 rest(of.position[i]);
        turn[i] = p == trees::none ? own : turn[p] * own;
        base[i] = p == trees::none ? rest : base[p] + turn[p] * (rest - glm::dvec3(of.position[p]));
        poses[i].rotation = glm::vec4(turn[i].x, turn[i].y, turn[i].z, turn[i].w);
        poses[i].shift = glm::vec3(base[i] - rest);
    }
    return poses;
}

template <backend B>
std::vector<surface_vertex> mesh_of(B& device, const trees::skeleton& skeleton,
                                    const std::vector<segment_pose>* poses,
                                    trees::mesh_form form = trees::mesh_form::rings) {
    trees::branch_mesh_options options;
    options.form = form;
    const auto mesh = trees::branch_mesh<B>::create(device, skeleton, options);
    EXPECT_TRUE(mesh) << mesh.error().message;
    const auto buffer = make_buffer<B, segment_pose>(
        device, poses != nullptr ? *poses : std::vector<segment_pose>(1));
    EXPECT_TRUE(buffer);
    const auto done = run(device, [&](auto& r) {
        poses != nullptr ? mesh->record(r, view<B>(*buffer)) : mesh->record(r);
    });
    EXPECT_TRUE(done) << done.error().message;
    auto made = mesh->download(device);
    EXPECT_TRUE(made) << made.error().message;
    return std::move(made->vertices);
}

bool same_bits(const std::vector<surface_vertex>& a, const std::vector<surface_vertex>& b) {
    return a.size() == b.size() &&
           std::memcmp(a.data(), b.data(), a.size() * sizeof(surface_vertex)) == 0;
}

const trees::skeleton& scan() {
    static const trees::skeleton tree = support::scanned_tree().skeleton;
    return tree;
}

void expect_rest_at_rest(const std::string& backend) {
    support::with_device(backend, [](auto& device) {
        const auto poses = poses_at_rest(scan());
        for (const auto form : {trees::mesh_form::rings, trees::mesh_form::list}) {
            EXPECT_TRUE(same_bits(mesh_of(device, scan(), nullptr, form),
                                  mesh_of(device, scan(), &poses, form)));
        }
    });
}

TEST(posing, rest_keeps_every_bit_on_cpu) { expect_rest_at_rest("cpu"); }
TEST(posing, rest_keeps_every_bit_on_opengl) { expect_rest_at_rest("opengl"); }
TEST(posing, rest_keeps_every_bit_on_vulkan) { expect_rest_at_rest("vulkan"); }

TEST(posing, one_body_moves_as_one) {
    cpu::device device;
    const moved body{glm::normalize(glm::dquat(0.8, 0.3, -0.4, 0.2)), {0.5, -1, 2}};
    const auto poses = poses_of_body(scan(), body);
    const auto rest = mesh_of(device, scan(), nullptr);
    const auto now = mesh_of(device, scan(), &poses);
    ASSERT_EQ(rest.size(), now.size());
    double far = 0;
    double turned = 0;
    for (std::size_t i = 0; i < rest.size(); ++i) {
        far = std::max(
            far, glm::distance(body(glm::dvec3(rest[i].position)), glm::dvec3(now[i].position)));
        turned = std::max(turned, glm::distance(body.turn * glm::dvec3(rest[i].normal),
                                                glm::dvec3(now[i].normal)));
    }
    // About 20 roundings of numbers below 16 m, and of unit quaternions.
    EXPECT_LT(far, 20 * 16 * 6e-8);
    EXPECT_LT(turned, 2e-5);
}

TEST(posing, a_joint_lies_where_its_lower_segment_ends_and_half_way_turned) {
    // Two segments on top of each other; the upper one turns by 60 degrees about z.
    std::vector<trees::segment> segments(2);
    segments[0] = {{0, 0, 0}, {0, 1, 0}, 0.1f, 0.1f, trees::none};
    segments[1] = {{0, 1, 0}, {0, 2, 0}, 0.1f, 0.1f, 0};
    const trees::skeleton two = support::built(segments);
    auto poses = poses_at_rest(two);
    const double half = glm::radians(30.0);
    poses[1].rotation = glm::vec4(0, 0, std::sin(half), std::cos(half));
    cpu::device device;
    const auto now = mesh_of(device, two, &poses);
    const auto rest = mesh_of(device, two, nullptr);
    ASSERT_EQ(now.size(), rest.size());
    const std::size_t ring = 9;
    const auto centre_of = [&](std::size_t first) {
        glm::dvec3 sum(0);
        for (std::size_t i = 0; i < 8; ++i) {
            sum += glm::dvec3(now[first + i].position);
        }
        return sum / 8.0;
    };
    const auto axis_of = [&](std::size_t first) {
        return glm::normalize(
            glm::cross(glm::dvec3(now[first].normal), glm::dvec3(now[first + 2].normal)));
    };
    EXPECT_LT(glm::distance(centre_of(3 * ring), glm::dvec3(0, 1, 0)), 1e-6);
    const glm::dvec3 tip(-std::sin(2 * half), 1 + std::cos(2 * half), 0);
    EXPECT_LT(glm::distance(centre_of(7 * ring), tip), 1e-6);
    const glm::dvec3 between(-std::sin(half), std::cos(half), 0);
    EXPECT_NEAR(std::abs(glm::dot(axis_of(3 * ring), between)), 1, 1e-6);
    for (std::size_t i = 0; i < ring; ++i) { // the upper segment's first ring is the joint's
        EXPECT_EQ(now[3 * ring + i].position, now[4 * ring + i].position);
    }
}

/// Divisions differ in the last bit between compilers of shaders and of C++: a few units in the
/// last place of coordinates below 16 m, and of unit normals after a division by sin of an angle.
void expect_cpu_mesh(const std::string& backend) {
    support::with_device(backend, [](auto& device) {
        cpu::device host;
        const auto poses = poses_bent(scan(), 0.3);
        const auto expected = mesh_of(host, scan(), &poses);
        const auto made = mesh_of(device, scan(), &poses);
        ASSERT_EQ(expected.size(), made.size());
        float far = 0;
        float turned = 0;
        for (std::size_t i = 0; i < made.size(); ++i) {
            far = std::max(far, glm::distance(expected[i].position, made[i].position));
            turned = std::max(turned, glm::distance(expected[i].normal, made[i].normal));
        }
        EXPECT_LT(far, 1e-5f);
        EXPECT_LT(turned, 1e-5f);
    });
}

TEST(posing, a_bent_tree_is_the_same_on_opengl) { expect_cpu_mesh("opengl"); }
TEST(posing, a_bent_tree_is_the_same_on_vulkan) { expect_cpu_mesh("vulkan"); }

} // namespace
