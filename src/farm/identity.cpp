#include "farm/identity.h"

#include <algorithm>

namespace glint::farm {

namespace {

using Fact = std::pair<std::string, std::string>;

const std::string* valueOf(const Identity& identity, const std::string& name) {
    const auto found = std::find_if(identity.facts.begin(), identity.facts.end(),
                                    [&](const Fact& fact) { return fact.first == name; });
    return found == identity.facts.end() ? nullptr : &found->second;
}

bool isHash(const std::string& name) {
    return name.starts_with("file ") || name == "cut";
}

std::string textOf(const Fact& there, const std::string& here) {
    if (there.first == "cut") return "the picture is cut at other places there";
    if (isHash(there.first)) return there.first + " has other contents there";
    return there.first + " is " + there.second + " there and " + here + " here";
}

}  // namespace

std::string difference(const Identity& there, const Identity& here) {
    for (const Fact& fact : there.facts) {
        const std::string* mine = valueOf(here, fact.first);
        if (!mine)
            return fact.first + (isHash(fact.first) ? " is used there alone" : " is given there alone");
        if (*mine != fact.second) return textOf(fact, *mine);
    }
    for (const auto& [name, value] : here.facts)
        if (!valueOf(there, name))
            return name + (isHash(name) ? " is used here alone" : " is given here alone");
    return there == here ? "" : "the same facts in another order";
}

}  // namespace glint::farm
