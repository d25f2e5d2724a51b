#include "filasofia/metric/sampling.h"

#include "filasofia/metric/sample_line.h"

#include <algorithm>
#include <utility>

namespace filasofia::metric {
namespace {

constexpr Vec3 kNowhere = {kNan, kNan, kNan};

void findPose(const frame::Frame& frame, const Observed& observed, Sample& sample)
{
    if (const auto* rigid = frame.rigidBody(observed.body)) {
        if (observed.element < 0 || observed.element >= static_cast<int>(rigid->poses.size())) return;
        sample.pose = rigid->poses[static_cast<std::size_t>(observed.element)] * Pose{observed.tip, {}};
    } else if (const auto* soft = frame.softBody(observed.body); soft && !soft->positions.empty()) {
        Vec3 sum = {};
        for (const Vec3& position : soft->positions) sum += position;
        sample.pose = {sum / static_cast<double>(soft->positions.size()), {}};
    }
}

} // namespace

Sample sampleOf(const frame::Frame& frame, const Observed& observed)
{
    Sample sample{.time = frame.time, .pose = {kNowhere, {}}, .force = kNowhere, .point = kNowhere};
    findPose(frame, observed, sample);
    if (!observed.force || !isFinite(sample.pose.position)) return sample;
    sample.force = {};
    double strongest = 0.0;
    for (const frame::Contact& contact : frame.contacts) {
        const bool first = contact.first == observed.body, second = contact.second == observed.body;
        if (first == second || contact.normalForce == 0.0)
            continue; // between other bodies, with itself, or without a force
        const Vec3 force = forceOn(observed.body, contact);
        sample.force += force;
        ++sample.contacts;
        if (length(force) <= strongest) continue;
        strongest = length(force);
        sample.point = contact.point;
    }
    for (const frame::Attachment& held : frame.attachments)
        if (held.to && (held.body == observed.body) != (held.to == observed.body) && held.points > 0) ++sample.contacts;
    sample.force += forceOn(observed.body, frame.attachments);
    return sample;
}

void StepSampler::add(const frame::Frame& frame, double dt)
{
    newest_ = sampleOf(frame, observed_);
    impulse_ += dt * newest_.force; // NaN stays NaN: what was not observed in between is not invented
    time_ += dt;
    if (contacts_ == 0) point_ = newest_.point;
    contacts_ = std::max(contacts_, newest_.contacts);
    if (const double size = length(newest_.force); size > strongest_) {
        strongest_ = size;
        point_ = newest_.point;
    }
}

Sample StepSampler::take()
{
    Sample sample = newest_;
    if (time_ > 0.0) sample.force = impulse_ / time_;
    sample.contacts = std::exchange(contacts_, 0);
    sample.point = point_;
    impulse_ = {};
    time_ = strongest_ = 0.0;
    return sample;
}

} // namespace filasofia::metric
