#include "filasofia/visual/transform.h"

#include "filasofia/core/error.h"

#include <algorithm>

namespace filasofia::visual {

Transform::Transform(std::string name) : name_(std::move(name)) {}

Transform::~Transform()
{
    while (!children_.empty()) children_.back()->detach();
    leaveParent();
}

void Transform::setPose(const Pose& pose)
{
    if (!isFinite(pose)) fail("'", name_, "': pose must be finite");
    const double square = dot(pose.orientation, pose.orientation);
    if (std::abs(square - 1.0) > 2e-6)
        fail("'", name_, "': pose.orientation must have length 1, got ", std::sqrt(square));
    pose_ = pose;
}

Pose Transform::worldPose() const
{
    Pose world = pose_;
    for (const Transform* above = parent_; above; above = above->parent_) {
        world.position *= above->scale_;
        world = above->pose_ * world;
    }
    world.orientation = normalized(world.orientation);
    return world;
}

void Transform::setScale(double scale)
{
    constexpr double kLargest = 1e6;
    if (!(scale > 0.0 && scale <= kLargest)) fail("'", name_, "': scale must be in (0, ", kLargest, "], got ", scale);
    scale_ = scale;
}

double Transform::worldScale() const { return parent_ ? scale_ * parent_->worldScale() : scale_; }

bool Transform::worldVisible() const { return visible_ && (!parent_ || parent_->worldVisible()); }

void Transform::attachTo(Transform& parent)
{
    for (const Transform* above = &parent; above; above = above->parent_)
        if (above == this) fail("'", name_, "' cannot be attached to '", parent.name_, "': that would be a cycle");
    leaveParent();
    parent_ = &parent;
    parent.children_.push_back(this);
}

void Transform::detach()
{
    const double scale = worldScale();
    pose_ = worldPose();
    scale_ = scale;
    leaveParent();
}

void Transform::leaveParent()
{
    if (parent_) std::erase(parent_->children_, this);
    parent_ = nullptr;
}

Pose lookAt(Vec3 eye, Vec3 target, Vec3 up)
{
    const Vec3 back = normalized(eye - target);
    if (back == Vec3{} || !isFinite(back)) fail("lookAt: eye and target must be finite and apart");
    Vec3 right = cross(up, back);
    // Parallel to the view, or nearly so: use the axis that is farthest from it.
    if (!isFinite(right) || lengthSquared(right) < 1e-12 * lengthSquared(up) || up == Vec3{})
        right = cross(std::abs(back.z) < 0.7 ? Vec3{0, 0, 1} : Vec3{1, 0, 0}, back);
    right = normalized(right);
    return {eye, toQuat(Mat3::columns(right, cross(back, right), back))};
}

} // namespace filasofia::visual
