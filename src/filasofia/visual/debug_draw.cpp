#include "filasofia/visual/debug_draw.h"

#include "filasofia/core/validate.h"
#include "filasofia/visual/debug_shapes.h"

#include <cmath>
#include <numbers>

namespace filasofia::visual {
namespace {

constexpr double kFar = 1e6; // [m], as for bodies: the picture is computed in float

std::array<std::uint8_t, 4> packed(const Color& color)
{
    const auto byte = [](double part) { return std::uint8_t(std::lround(255.0 * part)); };
    return {byte(color.red), byte(color.green), byte(color.blue), 255};
}

void checkPlace(Vec3 at, const char* field)
{
    if (!(std::abs(at.x) < kFar && std::abs(at.y) < kFar && std::abs(at.z) < kFar))
        fail("debug drawing: ", field, " must be finite and below 1e6 m, got ", at.x, " ", at.y, " ", at.z);
}

void checkStyle(const DebugStyle& style) { validate(style, "debug drawing: style"); }

void addQuad(DebugLayer& layer, const std::array<DebugVertex, 4>& corners)
{
    const auto first = static_cast<std::uint32_t>(layer.vertices.size());
    layer.vertices.insert(layer.vertices.end(), corners.begin(), corners.end());
    for (const std::uint32_t corner : {0U, 1U, 2U, 2U, 1U, 3U}) layer.indices.push_back(first + corner);
}

void append(const DebugLayer& from, DebugLayer& to)
{
    const auto base = static_cast<std::uint32_t>(to.vertices.size());
    to.vertices.insert(to.vertices.end(), from.vertices.begin(), from.vertices.end());
    for (const std::uint32_t index : from.indices) to.indices.push_back(base + index);
}

} // namespace

DebugLayer& DebugShapes::layerOf(const DebugStyle& style)
{
    DebugPicture& picture = (style.keep ? kept_ : once_).picture;
    return style.onTop ? picture.onTop : picture.inside;
}

void DebugShapes::line(Vec3 from, Vec3 to, const DebugStyle& style, const Color& color)
{
    const Float3 a = toFloat3(from), b = toFloat3(to);
    const auto width = float(style.width);
    const auto bytes = packed(color);
    const Float3 beyond = b + (b - a); // so that both ends have the same direction
    addQuad(layerOf(style), {{{a, b, width, {1, 0}, bytes},
                              {a, b, width, {-1, 0}, bytes},
                              {b, beyond, width, {1, 0}, bytes},
                              {b, beyond, width, {-1, 0}, bytes}}});
}

void DebugShapes::point(Vec3 at, const DebugStyle& style)
{
    const Float3 p = toFloat3(at);
    const auto width = float(style.width);
    const auto bytes = packed(style.color);
    addQuad(layerOf(style), {{{p, p, width, {-1, -1}, bytes},
                              {p, p, width, {1, -1}, bytes},
                              {p, p, width, {-1, 1}, bytes},
                              {p, p, width, {1, 1}, bytes}}});
}

void DebugShapes::cone(Vec3 base, Vec3 tip, double radius, const DebugStyle& style)
{
    constexpr int kSides = 10;
    const Vec3 axis = normalized(tip - base);
    const Vec3 aside = std::abs(axis.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    const Vec3 u = normalized(cross(axis, aside)), v = cross(axis, u);
    DebugLayer& layer = layerOf(style);
    const auto first = static_cast<std::uint32_t>(layer.vertices.size());
    const auto bytes = packed(style.color);
    const auto add = [&](Vec3 at) { layer.vertices.push_back({toFloat3(at), toFloat3(at), 0.0F, {0, 0}, bytes}); };
    add(tip);
    add(base);
    for (int i = 0; i < kSides; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / kSides;
        add(base + radius * (std::cos(angle) * u + std::sin(angle) * v));
    }
    for (std::uint32_t i = 0; i < kSides; ++i) {
        const std::uint32_t here = first + 2 + i, next = first + 2 + (i + 1) % kSides;
        for (const std::uint32_t corner : {first, here, next, first + 1, next, here}) layer.indices.push_back(corner);
    }
}

void DebugShapes::text(DebugText text, bool keep) { (keep ? kept_ : once_).texts.push_back(std::move(text)); }
void DebugShapes::clear() { once_ = kept_ = {}; }

DebugPicture DebugShapes::picture() const
{
    DebugPicture all = kept_.picture;
    append(once_.picture.inside, all.inside);
    append(once_.picture.onTop, all.onTop);
    return all;
}

std::vector<DebugText> DebugShapes::texts() const
{
    std::vector<DebugText> all = kept_.texts;
    all.insert(all.end(), once_.texts.begin(), once_.texts.end());
    return all;
}

DebugCounts DebugShapes::counts() const
{
    DebugCounts counts;
    for (const Set* set : {&once_, &kept_}) {
        counts.vertices += long(set->picture.inside.vertices.size() + set->picture.onTop.vertices.size());
        counts.texts += long(set->texts.size());
    }
    return counts;
}

void DebugShapes::endFrame() { once_ = {}; }

DebugDraw::DebugDraw(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
DebugDraw::~DebugDraw() = default;

void DebugDraw::line(Vec3 from, Vec3 to, const DebugStyle& style)
{
    checkStyle(style);
    checkPlace(from, "line: from");
    checkPlace(to, "line: to");
    impl_->shapes.line(from, to, style, style.color);
}

void DebugDraw::point(Vec3 at, const DebugStyle& style)
{
    checkStyle(style);
    checkPlace(at, "point: at");
    impl_->shapes.point(at, style);
}

void DebugDraw::arrow(Vec3 from, Vec3 to, const DebugStyle& style)
{
    checkStyle(style);
    checkPlace(from, "arrow: from");
    checkPlace(to, "arrow: to");
    const Vec3 way = to - from;
    if (length(way) < 1e-9) return; // without a direction it is not drawn
    const Vec3 neck = to - 0.2 * way;
    impl_->shapes.line(from, neck, style, style.color);
    impl_->shapes.cone(neck, to, 0.06 * length(way), style);
}

void DebugDraw::frame(const Pose& pose, double length, const DebugStyle& style)
{
    checkStyle(style);
    checkPlace(pose.position, "frame: pose.position");
    if (!isFinite(pose.orientation)) fail("debug drawing: frame: pose.orientation must be finite");
    if (!(length > 0.0 && length < kFar)) fail("debug drawing: frame: length must be in (0, 1e6) m, got ", length);
    constexpr Vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    constexpr Color colors[] = {{0.85, 0.03, 0.03}, {0.05, 0.6, 0.05}, {0.06, 0.2, 0.95}};
    for (std::size_t i = 0; i < 3; ++i) {
        DebugStyle colored = style;
        colored.color = colors[i];
        arrow(pose.position, transform(pose, length * axes[i]), colored);
    }
}

void DebugDraw::box(const geometry::Box& box, const Pose& pose, const DebugStyle& style)
{
    checkStyle(style);
    if (geometry::isEmpty(box)) fail("debug drawing: box: high must be >= low in every axis");
    const auto corner = [&](unsigned k) {
        const Vec3 local{(k & 1U) ? box.high.x : box.low.x, (k & 2U) ? box.high.y : box.low.y,
                         (k & 4U) ? box.high.z : box.low.z};
        return transform(pose, local);
    };
    for (unsigned k = 0; k < 8; ++k) checkPlace(corner(k), "box: corner");
    for (unsigned k = 0; k < 8; ++k)
        for (const unsigned axis : {1U, 2U, 4U})
            if ((k & axis) == 0) impl_->shapes.line(corner(k), corner(k | axis), style, style.color);
}

void DebugDraw::text(Vec3 at, std::string text, const DebugStyle& style)
{
    checkStyle(style);
    checkPlace(at, "text: at");
    impl_->shapes.text({at, std::move(text), style.color}, style.keep);
}

void DebugDraw::clear() { impl_->shapes.clear(); }
DebugCounts DebugDraw::counts() const { return impl_->shapes.counts(); }

} // namespace filasofia::visual
