// The hand motions: each is an approach to the surface and then a track along it, at hand speed.
#include "palpate/scenes/motions.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "palpate/names.hpp"
#include "scenes/contact.hpp"
#include "scenes/track.hpp"

namespace palpate::scenes {
namespace {

/// The start of every motion.
struct Hand {
    const Field& field;
    double isovalue;
    const MotionSettings& settings;
    Random random;
    Contact contact;

    Contact reach_for(const Vec3& target, const Vec3& inward) const {
        return reach(field, isovalue, target, inward);
    }
    double voxel() const { return field.geometry().spacing.minCoeff(); }
    double rounding() const { return 1.5 * field.geometry().spacing.mean(); }
    Vec3 centre() const { return physical_centre(field.geometry()); }
    /// The contact pressed in by the depth, along the normal.
    Vec3 pressed(const Contact& at) const {
        return at.point + settings.depth_mm * inward_normal(field, at);
    }
};

enum class Then { hold, there_and_back, round_and_round };

/// First the approach, once; then the track.
struct Plan {
    Track approach;
    Track track;
    Then then = Then::hold;
    double track_speed = 0;  // [mm/s]
};

/// From outside straight to `goal`, in at most `share` of the duration: a hand that has less time
/// starts nearer.
Track way_in(const Hand& hand, const Contact& contact, const Vec3& goal, double share) {
    const double time = share * hand.settings.duration_s - Journey::ramp_s;
    const double longest = hand.settings.speed_mm_s * time - hand.settings.depth_mm;
    const double nearest = std::min(hand.voxel(), contact.clearance);
    const double standoff = std::clamp(longest, nearest, std::max(nearest, contact.clearance));
    return Track({contact.point - standoff * contact.inward, goal});
}

Plan approach(Hand& hand) {
    const Vec3 goal = hand.pressed(hand.contact);
    return {way_in(hand, hand.contact, goal, 0.7), Track({goal}), Then::hold,
            hand.settings.speed_mm_s};
}

/// Out to the surface and in again, a second each way.
Plan press(Hand& hand) {
    const Vec3 goal = hand.pressed(hand.contact);
    return {way_in(hand, hand.contact, goal, 0.3), Track({goal, hand.contact.point}),
            Then::there_and_back, std::min(hand.settings.speed_mm_s, hand.settings.depth_mm)};
}

/// Off the surface and back, at most 2.5 times a second.
Plan tap(Hand& hand) {
    const Contact& contact = hand.contact;
    const Vec3 goal = hand.pressed(contact);
    const double lift = std::max(2 * hand.voxel(), hand.settings.depth_mm);
    const Track stroke({goal, contact.point - std::min(lift, contact.clearance) * contact.inward});
    return {way_in(hand, contact, goal, 0.3), stroke, Then::there_and_back,
            std::min(hand.settings.speed_mm_s, stroke.length() / Journey::ramp_s)};
}

/// Follows the surface sideways by parallel searches. Where the surface ends or jumps by more than
/// a few voxels (a hole, a cliff) the hand continues at the height where it was.
class Sideways {
  public:
    Sideways(const Hand& hand, const Contact& start)
        : hand_(hand), at_(start), normal_(inward_normal(hand.field, start)) {}

    void move(const Vec3& sideways) {
        const Contact next = hand_.reach_for(at_.point + sideways, at_.inward);
        const double jump = std::abs((next.point - at_.point).dot(at_.inward));
        if (next.found && jump <= 3 * sideways.norm() + hand_.voxel()) {
            at_ = next;
            normal_ = inward_normal(hand_.field, next);
        } else {
            at_.point += sideways;
        }
    }
    const Contact& contact() const { return at_; }
    Vec3 pressed() const { return at_.point + hand_.settings.depth_mm * normal_; }

  private:
    const Hand& hand_;
    Contact at_;
    Vec3 normal_;
};

/// The grid's length [mm] along neither its longest nor its shortest axis.
double middle_length(const Geometry& geometry) {
    const Vec3 length = geometry.size.cast<double>().cwiseProduct(geometry.spacing);
    return length.sum() - length.minCoeff() - length.maxCoeff();
}

/// A quarter of the grid to each side of the contact, there and back.
Plan slide(Hand& hand) {
    const Geometry& geometry = hand.field.geometry();
    const Vec3 along = unit_vector_across(hand.contact.inward, hand.random);
    const double side = 0.25 * std::min(chord(geometry, along), middle_length(geometry));
    const int steps = static_cast<int>(std::clamp(std::ceil(2 * side / hand.voxel()), 8.0, 2000.0));
    std::vector<Vec3> points;
    Sideways back(hand, hand.contact);
    for (int i = 0; i < steps; ++i) {
        back.move(along * (-side / steps));
        points.push_back(back.pressed());
    }
    std::reverse(points.begin(), points.end());
    Sideways forth(hand, hand.contact);
    points.push_back(forth.pressed());
    for (int i = 0; i < steps; ++i) {
        forth.move(along * (side / steps));
        points.push_back(forth.pressed());
    }
    const Track track = rounded(Track(points), hand.rounding(), false);
    return {way_in(hand, back.contact(), track.points().front(), 0.3), track, Then::there_and_back,
            hand.settings.speed_mm_s};
}

/// Unit vectors once round, from u towards v, without sine and cosine: four times the rational
/// quarter circle. Nearly even, and travelled by arc length anyway.
std::vector<Vec3> directions_round(const Vec3& u, const Vec3& v, int per_quarter) {
    std::vector<Vec3> directions;
    const std::array<Vec3, 5> axes{u, v, -u, -v, u};
    for (std::size_t quarter = 0; quarter < 4; ++quarter) {
        for (int i = 0; i < per_quarter; ++i) {
            const double h = static_cast<double>(i) / per_quarter;
            directions.push_back((axes[quarter] * (1 - h * h) + axes[quarter + 1] * (2 * h)) /
                                 (1 + h * h));
        }
    }
    return directions;
}

/// Fills what was not found between its neighbours, cyclically; at least one is found.
std::vector<double> without_gaps(const std::vector<std::optional<double>>& found) {
    const std::size_t count = found.size();
    std::size_t first = 0;
    while (!found[first]) ++first;
    std::vector<double> filled(count);
    for (std::size_t from = first; from < first + count;) {
        std::size_t to = from + 1;
        while (!found[to % count]) ++to;
        const double a = *found[from % count], b = *found[to % count];
        for (std::size_t i = from; i < to; ++i) {
            const double share = static_cast<double>(i - from) / static_cast<double>(to - from);
            filled[i % count] = a + share * (b - a);
        }
        from = to;
    }
    return filled;
}

/// Around the grid's z axis through its centre (for the cylinder: around its axis). Empty if fewer
/// than half of the rays towards the centre meet data.
std::vector<Vec3> ring_round_centre(const Hand& hand) {
    const Mat3& axes = hand.field.geometry().direction;
    const auto outward = directions_round(axes.col(0), axes.col(1), 64);
    std::vector<std::optional<double>> radius(outward.size());
    std::size_t met = 0;
    for (std::size_t i = 0; i < outward.size(); ++i) {
        const Contact contact = hand.reach_for(hand.centre(), -outward[i]);
        const double distance = (contact.point - hand.centre()).dot(outward[i]);
        if (!contact.found || contact.at_border || distance <= 0) continue;
        radius[i] = std::max(0.0, distance - hand.settings.depth_mm);
        ++met;
    }
    std::vector<Vec3> points;
    if (2 * met < outward.size()) return points;
    const auto filled = without_gaps(radius);
    for (std::size_t i = 0; i < outward.size(); ++i) {
        points.push_back(hand.centre() + filled[i] * outward[i]);
    }
    return points;
}

/// A circle on the face of the surface around the first contact.
std::vector<Vec3> ring_round_contact(Hand& hand) {
    const Vec3 u = unit_vector_across(hand.contact.inward, hand.random);
    const Vec3 v = hand.contact.inward.cross(u);
    const Geometry& geometry = hand.field.geometry();
    const double radius = 0.15 * std::min(chord(geometry, u), chord(geometry, v));
    Sideways at(hand, hand.contact);
    std::vector<Vec3> points;
    const auto way = directions_round(u, v, 64);
    constexpr int steps_out = 32;
    for (int i = 0; i < steps_out; ++i) {
        at.move(way.front() * (radius / steps_out));
    }
    Vec3 before = way.front();
    for (const Vec3& direction : way) {
        at.move(radius * (direction - before));
        before = direction;
        points.push_back(at.pressed());
    }
    return points;
}

Plan circle(Hand& hand) {
    std::vector<Vec3> points = ring_round_centre(hand);
    Vec3 inward = hand.contact.inward;
    if (points.empty()) {
        points = ring_round_contact(hand);
    } else {
        inward = -hand.field.geometry().direction.col(0);
    }
    points.push_back(points.front());
    const Track track = rounded(Track(points), hand.rounding(), true);
    const Vec3 start = track.points().front();
    return {way_in(hand, hand.reach_for(start, inward), start, 0.3), track, Then::round_and_round,
            hand.settings.speed_mm_s};
}

/// Wanders over the body: sweeps along the surface at depth, then lifts off and moves to another
/// place nearby. Side and target change only a little each time, so that the hand moves around the
/// body and not through it.
class Wanderer {
  public:
    explicit Wanderer(Hand& hand)
        : hand_(hand), inward_(hand.contact.inward), target_(hand.contact.point) {
        const Geometry& geometry = hand.field.geometry();
        longest_ = geometry.size.cast<double>().cwiseProduct(geometry.spacing).maxCoeff();
        hover_ = std::max(2 * hand.voxel(), 0.08 * longest_);
        hover();
    }

    /// The track so far [mm].
    double length() const { return length_; }
    const std::vector<Vec3>& points() const { return points_; }

    void sweep() {
        constexpr int steps = 8;
        const Vec3 along = unit_vector_across(inward_, hand_.random);
        for (int i = 0; i < steps; ++i) {
            const Contact contact = hand_.reach_for(target_, inward_);
            visit(contact, hand_.pressed(contact));
            target_ += along * (0.02 * longest_);
            inward_ = (inward_ - 0.04 * along).normalized();
        }
        hover();
    }

    void go_over() {
        constexpr int steps = 5, tries = 8;
        const Vec3 side_before = inward_, target_before = target_;
        Vec3 side, target;
        for (int i = 0; i < tries; ++i) {
            side = (side_before + 0.7 * unit_vector(hand_.random)).normalized();
            const double away = 0.25 * longest_ * hand_.random.uniform();  // before the next draw
            target = hand_.centre() + away * unit_vector(hand_.random);
            const Contact there = hand_.reach_for(target, side);
            if (there.found && !there.at_border) break;
        }
        for (int i = 1; i <= steps; ++i) {
            const double share = static_cast<double>(i) / steps;
            inward_ = (side_before + share * (side - side_before)).normalized();
            target_ = target_before + share * (target - target_before);
            hover();
        }
    }

  private:
    void add(const Vec3& point) {
        if (!points_.empty()) length_ += (point - points_.back()).norm();
        points_.push_back(point);
    }
    /// To a place where the surface is far from the last one (beyond a hole, behind an edge) the
    /// hand moves along its own approach: out of the grid and in again.
    void visit(const Contact& contact, const Vec3& point) {
        if (!points_.empty() && (contact.point - last_.point).norm() > 0.2 * longest_) {
            add(last_.point - last_.clearance * last_.inward);
            add(contact.point - contact.clearance * contact.inward);
        }
        add(point);
        last_ = contact;
    }
    void hover() {
        const Contact contact = hand_.reach_for(target_, inward_);
        visit(contact, contact.point - std::min(hover_, contact.clearance) * contact.inward);
    }

    Hand& hand_;
    Vec3 inward_;
    Vec3 target_;
    double longest_ = 0, hover_ = 0;
    double length_ = 0;
    Contact last_;
    std::vector<Vec3> points_;
};

Plan explore(Hand& hand) {
    // More places than that are not more varied; the hand then moves back along the track.
    constexpr int most_places = 64;
    Wanderer wanderer(hand);
    const double needed = 1.2 * hand.settings.speed_mm_s * hand.settings.duration_s;
    for (int i = 0; i < most_places && (i == 0 || wanderer.length() < needed); ++i) {
        wanderer.sweep();
        wanderer.go_over();
    }
    const Track track = rounded(Track(wanderer.points()), hand.rounding(), false);
    return {Track({track.points().front()}), track, Then::there_and_back, hand.settings.speed_mm_s};
}

/// The place of the hand at a time. It turns as sharply as the tracks do.
class Course {
  public:
    Course(const Plan& plan, double speed_mm_s)
        : plan_(plan),
          in_(plan.approach.length(), speed_mm_s),
          on_(plan.track.length(), plan.track_speed) {}

    Vec3 at(double t) const {
        const double since = t - in_.duration();
        if (since < 0) return plan_.approach.at(in_.travelled(t));
        if (plan_.then == Then::hold) return plan_.track.at(0);
        if (plan_.then == Then::there_and_back) return plan_.track.at(on_.there_and_back(since));
        const double arc = on_.without_end(since), once = plan_.track.length();
        return plan_.track.at(once > 0 ? arc - once * std::floor(arc / once) : 0);
    }

  private:
    const Plan& plan_;
    Journey in_, on_;
};

/// Reports that one of `count` samples is done.
void tell(const OnProgress& progress, std::size_t done, std::size_t count) {
    constexpr std::size_t between = 4096;
    if (progress && done % between == 0) {
        progress(static_cast<double>(done) / static_cast<double>(count));
    }
}

/// The trajectory, averaged over 31 ms. This cannot make it faster, and it bounds the change of the
/// velocity in a tick for any corner of the surface (2/31 of the speed at 1 kHz).
std::vector<HandSample> travelled(const Plan& plan, const MotionSettings& settings,
                                  std::vector<HandSample> samples, const OnProgress& progress) {
    constexpr double half_window_s = 0.015;
    const auto half = static_cast<std::size_t>(half_window_s * settings.rate_hz);
    const Course course(plan, settings.speed_mm_s);
    std::vector<Vec3> sharp(samples.size() + 2 * half);
    for (std::size_t i = 0; i < sharp.size(); ++i) {
        const double tick = static_cast<double>(i) - static_cast<double>(half);
        sharp[i] = course.at(tick / settings.rate_hz);
        tell(progress, i, 2 * sharp.size());
    }
    for (std::size_t i = 0; i < samples.size(); ++i) {
        Vec3 sum = Vec3::Zero();
        for (std::size_t j = i; j <= i + 2 * half; ++j) sum += sharp[j];
        samples[i].position = sum / static_cast<double>(2 * half + 1);
        tell(progress, samples.size() + i, 2 * samples.size());
    }
    return samples;
}

/// Steps of every size from far below a voxel to the whole grid, rests, and jumps to any place in
/// the grid with two voxels around it. No hand does this, but every update must cope with it.
std::vector<HandSample> jumping(const Field& field, Random random, std::vector<HandSample> samples,
                                const OnProgress& progress) {
    const Geometry& geometry = field.geometry();
    const Vec3 low = Vec3::Constant(-2), high = geometry.size.cast<double>() + Vec3::Ones();
    const auto anywhere = [&] {
        Vec3 index;
        for (int a = 0; a < 3; ++a) index[a] = random.uniform(low[a], high[a]);
        return index;
    };
    Vec3 index = anywhere();
    for (std::size_t i = 0; i < samples.size(); ++i) {
        tell(progress, i, samples.size());
        const std::uint64_t what = random.bits() % 64;
        if (what == 0) {
            index = anywhere();
        } else if (what > 4) {  // 1 to 4 rest
            const double size = std::ldexp((high - low).norm(), -static_cast<int>(what % 32));
            index = (index + size * unit_vector(random)).cwiseMax(low).cwiseMin(high);
        }
        samples[i].position = physical_from_index(geometry, index);
    }
    return samples;
}

std::vector<HandSample> clock(const MotionSettings& settings) {
    const auto needs = [](bool ok, const char* what) {
        if (!ok) throw std::invalid_argument(std::string("a motion needs ") + what);
    };
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const auto positive = [](double v) { return v > 0 && v < infinity; };
    const auto not_negative = [](double v) { return v >= 0 && v < infinity; };
    needs(positive(settings.rate_hz), "a rate above 0 Hz");
    needs(not_negative(settings.duration_s), "a duration of 0 s or more");
    needs(positive(settings.speed_mm_s), "a speed above 0 mm/s");
    needs(not_negative(settings.depth_mm), "a depth of 0 mm or more");
    const double steps = std::round(settings.duration_s * settings.rate_hz);
    needs(steps <= 1e8, "at most 100 million samples: a shorter duration or a lower rate");
    std::vector<HandSample> samples(static_cast<std::size_t>(steps) + 1);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        samples[i].t = static_cast<double>(i) / settings.rate_hz;
    }
    return samples;
}

struct Motion {
    const char* name;
    Plan (*plan)(Hand&);  // none for random
};

constexpr std::array<Motion, 7> motions{{{"approach", approach},
                                         {"press", press},
                                         {"slide", slide},
                                         {"circle", circle},
                                         {"tap", tap},
                                         {"explore", explore},
                                         {"random", nullptr}}};

}  // namespace

std::vector<std::string> motion_names() {
    std::vector<std::string> names;
    for (const Motion& motion : motions) names.emplace_back(motion.name);
    return names;
}

std::vector<HandSample> make_motion(std::string_view name, const Field& field, double isovalue,
                                    const MotionSettings& settings, const OnProgress& progress) {
    for (const Motion& motion : motions) {
        if (name != motion.name) continue;
        std::vector<HandSample> samples = clock(settings);
        Random random(settings.seed);
        if (motion.plan == nullptr) {
            return jumping(field, random, std::move(samples), progress);
        }
        const Contact contact = any_contact(field, isovalue, random);
        Hand hand{field, isovalue, settings, random, contact};
        return travelled(motion.plan(hand), settings, std::move(samples), progress);
    }
    throw std::invalid_argument("there is no motion '" + std::string(name) +
                                "': " + use_one_of(motion_names(), name));
}

}  // namespace palpate::scenes
