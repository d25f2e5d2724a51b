#include "filasofia/frame/contact.h"

#include "filasofia/frame/attachment.h"

#include <algorithm>
#include <map>
#include <utility>

namespace filasofia::frame {

Vec3 forceOn(BodyId body, const std::vector<Contact>& contacts)
{
    Vec3 sum = {};
    for (const Contact& contact : contacts)
        if ((contact.first == body) != (contact.second == body)) sum += forceOn(body, contact);
    return sum;
}

Vec3 forceOn(BodyId body, const std::vector<Attachment>& attachments)
{
    Vec3 sum = {};
    for (const Attachment& each : attachments)
        if (each.to && (each.body == body) != (each.to == body)) sum += each.body == body ? each.force : -each.force;
    return sum;
}

std::vector<ContactPair> contactPairs(const std::vector<Contact>& contacts)
{
    std::map<std::pair<BodyId, BodyId>, ContactPair> sums;
    for (const Contact& contact : contacts) {
        ContactPair& pair = sums[{contact.first, contact.second}];
        pair.first = contact.first;
        pair.second = contact.second;
        pair.contacts += contact.normalForce != 0.0 ? 1 : 0;
        pair.force += forceOn(contact.first, contact);
        pair.normalForce += contact.normalForce;
        pair.frictionForce += length(contact.friction);
    }
    std::vector<ContactPair> pairs;
    for (const auto& [bodies, pair] : sums) pairs.push_back(pair);
    return pairs;
}

bool connected(BodyId one, BodyId other, const std::vector<Attachment>& attachments)
{
    std::vector<BodyId> reached{one};
    for (std::size_t i = 0; i < reached.size(); ++i) {
        if (reached[i] == other) return true;
        for (const Attachment& each : attachments) {
            if (each.broken || !each.to || (each.body != reached[i] && each.to != reached[i])) continue;
            const BodyId next = each.body == reached[i] ? each.to : each.body;
            if (std::ranges::count(reached, next) == 0) reached.push_back(next);
        }
    }
    return false;
}

} // namespace filasofia::frame
