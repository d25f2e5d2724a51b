#include "filasofia/visual/filament_smoke.h"

#include "filasofia/math/gaussian.h"
#include "filasofia/visual/owned_buffer.h"

#include <filament/RenderableManager.h>
#include <filament/TextureSampler.h>
#include <filament/Viewport.h>
#include <math/vec3.h>
#include <utils/EntityManager.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace filasofia::visual {
namespace {

constexpr std::size_t kMostQuads = 257; ///< puffs, and haze
constexpr double kReach = 2.8;          ///< standard deviations, beyond which a puff is not seen
/// Light that goes one way per light that arrives, scattered once; the same in smoke.mat for haze. In thick smoke it is
/// scattered again and again, until it is nearly as bright as a white wall, 1 / pi.
constexpr double kScattered = 1.0 / (4.0 * std::numbers::pi);
double again(double depth) { return 1.0 - 2.6 * std::expm1(-depth); }

/// Most of the scattered light goes on ahead, so less of it is lost on its way to a puff than of what is seen behind
/// it: as in so much of the smoke (similarity for an asymmetry of 0.65).
constexpr double kLost = 0.35;

struct Corner {
    Float3 place;   ///< in the camera's coordinates
    float exposure; ///< that haze is drawn with
    float unused;
    std::array<float, 4> what, look, more; ///< see smoke.mat
};
struct CoverCorner {
    float x, y, u, v;
};
constexpr CoverCorner kCover[3] = {{-1, -1, 0, 0}, {3, -1, 2, 0}, {-1, 3, 0, 2}};
constexpr std::uint16_t kTriangle[3] = {0, 1, 2};

std::array<float, 4> packed(Vec3 a, double b) { return {float(a.x), float(a.y), float(a.z), float(b)}; }
Vec3 vec(const Color& color) { return {color.red, color.green, color.blue}; }

/// What a light gives [lx] at a place; as Filament's lights fall off.
double illuminance(const LightDef& def, const Pose& pose, Vec3 at)
{
    const Vec3 away = at - pose.position;
    const double squared = std::max(lengthSquared(away), 1e-4);
    const auto fading = [&](double range) {
        const double share = std::max(1.0 - squared * squared / (range * range * range * range), 0.0);
        return share * share / squared;
    };
    if (const auto* spot = std::get_if<SpotLight>(&def.kind)) {
        const double cosine = dot(away, rotate(pose.orientation, {0, 0, -1})) / std::sqrt(squared);
        const double inner = std::cos(spot->innerAngle), outer = std::cos(spot->outerAngle);
        const double cone = std::clamp((cosine - outer) / std::max(inner - outer, 1e-4), 0.0, 1.0);
        return spot->intensity * cone * cone * fading(spot->range);
    }
    if (const auto* point = std::get_if<PointLight>(&def.kind)) return point->intensity * fading(point->range);
    return std::get<DirectionalLight>(def.kind).illuminance;
}

double intensityOf(const LightDef& def)
{
    if (const auto* spot = std::get_if<SpotLight>(&def.kind)) return spot->intensity;
    if (const auto* point = std::get_if<PointLight>(&def.kind)) return point->intensity;
    return 0.0;
}

} // namespace

SmokePass::SmokePass(filament::Engine& engine, filament::Scene& scene, MaterialPool& pool)
    : engine_(engine), scene_(scene), pool_(pool), depth_(engine, pool)
{
    make();
}

void SmokePass::make()
{
    using Attribute = filament::VertexAttribute;
    using Type = filament::VertexBuffer::AttributeType;
    using filament::TextureSampler;
    auto& entities = utils::EntityManager::get();
    cloud_ = entities.create();
    cover_ = entities.create();
    air_ = engine_.createScene();
    view_ = engine_.createView();
    view_->setScene(air_);
    view_->setPostProcessingEnabled(false); // what it draws is light, not colours
    view_->setShadowingEnabled(false);
    picture_ = std::make_unique<DrawnPicture>(engine_, kWidth, kHeight, DrawnPicture::Content::Light);
    view_->setRenderTarget(picture_->target());
    view_->setViewport({0, 0, std::uint32_t(kWidth), std::uint32_t(kHeight)});
    puffs_ = pool_.get("smoke").createInstance();
    puffs_->setParameter("depth", depth_.prepare(2 * kWidth, 2 * kHeight).texture(), TextureSampler());
    over_ = pool_.get("air").createInstance();
    over_->setParameter("smoke", picture_->texture(), TextureSampler(TextureSampler::MagFilter::LINEAR));
    over_->setParameter("depth", depth_.prepare(2 * kWidth, 2 * kHeight).texture(), TextureSampler());

    corners_ = filament::VertexBuffer::Builder()
                   .vertexCount(4 * kMostQuads)
                   .bufferCount(1)
                   .attribute(Attribute::POSITION, 0, Type::FLOAT3, offsetof(Corner, place), sizeof(Corner))
                   .attribute(Attribute::UV0, 0, Type::FLOAT2, offsetof(Corner, exposure), sizeof(Corner))
                   .attribute(Attribute::CUSTOM0, 0, Type::FLOAT4, offsetof(Corner, what), sizeof(Corner))
                   .attribute(Attribute::CUSTOM1, 0, Type::FLOAT4, offsetof(Corner, look), sizeof(Corner))
                   .attribute(Attribute::CUSTOM2, 0, Type::FLOAT4, offsetof(Corner, more), sizeof(Corner))
                   .build(engine_);
    std::vector<std::uint16_t> quads;
    for (std::size_t quad = 0; quad < kMostQuads; ++quad)
        for (const std::size_t corner : {0, 1, 2, 2, 1, 3})
            quads.push_back(static_cast<std::uint16_t>(4 * quad + corner));
    indices_ = filament::IndexBuffer::Builder()
                   .indexCount(static_cast<std::uint32_t>(quads.size()))
                   .bufferType(filament::IndexBuffer::IndexType::USHORT)
                   .build(engine_);
    indices_->setBuffer(engine_, ownedBuffer(std::move(quads)));
    const auto build = [&](utils::Entity entity, filament::MaterialInstance* instance, auto* vertices, auto* indices,
                           std::size_t count) {
        using Renderable = filament::RenderableManager;
        Renderable::Builder(1)
            .boundingBox({{0, 0, 0}, {1e6F, 1e6F, 1e6F}})
            .culling(false)
            .geometry(0, Renderable::PrimitiveType::TRIANGLES, vertices, indices, 0, count)
            .material(0, instance)
            .priority(6) // after all bodies, before debug drawings on top
            .castShadows(false)
            .receiveShadows(false)
            .build(engine_, entity);
    };
    build(cloud_, puffs_, corners_, indices_, 6 * kMostQuads);
    air_->addEntity(cloud_);

    screen_ = filament::VertexBuffer::Builder()
                  .vertexCount(3)
                  .bufferCount(1)
                  .attribute(Attribute::POSITION, 0, Type::FLOAT2, 0, sizeof(CoverCorner))
                  .attribute(Attribute::UV0, 0, Type::FLOAT2, 8, sizeof(CoverCorner))
                  .build(engine_);
    screen_->setBufferAt(engine_, 0, {kCover, sizeof(kCover)});
    triangle_ = filament::IndexBuffer::Builder()
                    .indexCount(3)
                    .bufferType(filament::IndexBuffer::IndexType::USHORT)
                    .build(engine_);
    triangle_->setBuffer(engine_, {kTriangle, sizeof(kTriangle)});
    build(cover_, over_, screen_, triangle_, 3);
}

SmokePass::~SmokePass()
{
    scene_.remove(cover_);
    engine_.destroy(view_);
    for (const utils::Entity each : {cloud_, cover_}) {
        engine_.destroy(each); // before what it draws with
        utils::EntityManager::get().destroy(each);
    }
    engine_.destroy(air_);
    for (filament::MaterialInstance* each : {puffs_, over_}) engine_.destroy(each);
    for (filament::VertexBuffer* each : {corners_, screen_}) engine_.destroy(each);
    for (filament::IndexBuffer* each : {indices_, triangle_}) engine_.destroy(each);
}

void SmokePass::set(const Smoke& smoke)
{
    smoke_ = smoke;
    if (empty() == !shown_) return;
    shown_ = !empty();
    if (shown_)
        scene_.addEntity(cover_);
    else
        scene_.remove(cover_);
}

/// Each puff scatters what the lights and the surroundings send to its middle, less what smoke on the way takes.
void SmokePass::light(const std::vector<SmokeLight>& lights, const std::array<double, 3>& ambient)
{
    const Vec3 color = vec(smoke_.color), sides{ambient[0], ambient[1], ambient[2]};
    lamp_ = {.visible = false};
    for (const SmokeLight& each : lights)
        if (each.visible && (!lamp_.visible || intensityOf(each.def) > intensityOf(lamp_.def))) lamp_ = each;
    const auto scatteredOf = [&](Vec3 light) {
        const Float3 out = toFloat3({color.x * light.x, color.y * light.y, color.z * light.z});
        return filament::math::float3{out.x, out.y, out.z};
    };
    puffs_->setParameter("hazeSides", scatteredOf(sides));
    puffs_->setParameter(
        "hazeLamp", scatteredOf(lamp_.visible ? kScattered * intensityOf(lamp_.def) * vec(lamp_.def.color) : Vec3{}));
    shone_.clear();
    for (const SmokePuff& puff : smoke_.puffs) {
        Vec3 sum = sides;
        for (const SmokeLight& each : lights) {
            if (!each.visible) continue;
            Vec3 from = each.pose.position;
            if (std::holds_alternative<DirectionalLight>(each.def.kind)) {            // from outside the room
                const double far = 1.0 + distance(smoke_.room.low, smoke_.room.high); // [m]
                from = puff.place - far * rotate(each.pose.orientation, {0, 0, -1});
            }
            double depth = smoke_.haze * geometry::lengthWithin(smoke_.room, from, puff.place);
            for (const SmokePuff& other : smoke_.puffs)
                depth += other.depth * gaussianColumn(other.place, other.radius, from, puff.place);
            sum += kScattered * again(puff.depth) * illuminance(each.def, each.pose, puff.place) *
                   std::exp(-kLost * depth) * vec(each.def.color);
        }
        shone_.push_back(toFloat3({color.x * sum.x, color.y * sum.y, color.z * sum.z}));
    }
}

/// The puffs as this camera sees them, from the farthest to the nearest; haze is in front.
void SmokePass::upload(const SmokeEye& eye)
{
    const double exposure = std::exp2(-eye.def.exposure) / 1.2; // Filament's
    const double tall = std::tan(0.5 * eye.def.verticalFieldOfView), wide = tall * eye.aspect;
    const double front = 2.0 * eye.def.near;
    // A little more than the picture, at twice the near distance.
    const std::array<Vec3, 4> all{
        Vec3{-1.1 * front * wide, -1.1 * front * tall, -front}, Vec3{1.1 * front * wide, -1.1 * front * tall, -front},
        Vec3{-1.1 * front * wide, 1.1 * front * tall, -front}, Vec3{1.1 * front * wide, 1.1 * front * tall, -front}};
    const Pose toEye = inverse(eye.pose);
    std::vector<std::size_t> order(smoke_.puffs.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto distance = [&](std::size_t i) { return length(smoke_.puffs[i].place - eye.pose.position); };
    std::ranges::stable_sort(order, std::greater(), distance);

    std::vector<Corner> corners;
    corners.reserve(4 * kMostQuads);
    const auto add = [&](const std::array<Vec3, 4>& places, Corner corner) {
        for (const Vec3& each : places) {
            corner.place = toFloat3(each);
            corners.push_back(corner);
        }
    };
    for (const std::size_t i : order) {
        const SmokePuff& puff = smoke_.puffs[i];
        const Vec3 middle = transform(toEye, puff.place);
        const double far = length(middle), reach = kReach * puff.radius;
        if (middle.z > reach) continue; // behind the camera
        const Float3 shone = shone_[i];
        const Corner corner{.place = {},
                            .exposure = 0.0F,
                            .unused = 0.0F,
                            .what = packed(middle, puff.radius),
                            .look = {float(exposure) * shone.x, float(exposure) * shone.y, float(exposure) * shone.z,
                                     float(puff.depth)},
                            .more = {float(puff.pattern), float(smoke_.wisps), 0.0F, 0.0F}};
        if (far < 1.1 * reach || -middle.z < reach + front) { // the camera is in it, or next to it
            add(all, corner);
            continue;
        }
        // The square that hides a sphere of this radius.
        const double size = reach * far / std::sqrt(far * far - reach * reach);
        const Vec3 ahead = 1.0 / far * middle;
        const Vec3 right = size * normalized(cross(ahead, Vec3{0, 1, 0.01})), up = cross(right, ahead);
        add({middle - right - up, middle + right - up, middle - right + up, middle + right + up}, corner);
    }
    if (smoke_.haze > 0.0) {
        const Vec3 lamp = transform(toEye, lamp_.pose.position);
        add(all, {.place = {},
                  .exposure = float(exposure),
                  .unused = 0.0F,
                  .what = packed(smoke_.room.low - eye.pose.position, 0.0),
                  .look = packed(smoke_.room.high - eye.pose.position, smoke_.haze),
                  .more = packed(lamp, 0.0)});
    }
    corners.resize(4 * kMostQuads); // the rest has no size
    corners_->setBufferAt(engine_, 0, ownedBuffer(std::move(corners)));
}

} // namespace filasofia::visual
