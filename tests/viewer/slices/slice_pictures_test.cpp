// Pictures of slice panes on real data, for people to look at.
#include <QGridLayout>
#include <QPalette>

#include <filesystem>

#include "palpate/run/source.hpp"
#include "support/fields.hpp"
#include "viewer/slices/pane_support.hpp"

namespace palpate::viewer {
namespace {

Volume real(const std::string& name) {
    return run::load(run::source_named(std::string(PALPATE_DATA_FOLDER) + "/" + name)).volume;
}

bool there_is(const std::string& name) {
    return std::filesystem::exists(std::string(PALPATE_DATA_FOLDER) + "/" + name);
}

/// Three panes round a contact with what is felt.
struct ThreePanes {
    QWidget window;
    std::array<SlicePane*, 3> panes;

    ThreePanes(const Field& field, double isovalue, const Vec3& hand_from) {
        auto* layout = new QGridLayout(&window);
        Proxy proxy;
        place(proxy, field, hand_from, isovalue);
        const Vec3 middle = physical_centre(field.geometry());
        const RayHit hit = cast_ray(field, isovalue, hand_from, middle);
        // 6 mm into what is there.
        const Vec3 hip = hit.point + 6 * (middle - hand_from).normalized();
        const ProxyUpdate update = update_exact(proxy, field, hip);
        for (const int axis : {0, 1, 2}) {
            auto* pane = panes[std::size_t(axis)] = new SlicePane(axis);
            pane->set_field(field, isovalue);
            pane->set_crosshair(update.scp);
            pane->show_snapshot(contact_at(hip, update.scp, 0.3 * (update.scp - hip)));
            layout->addWidget(pane, 0, 2 - axis);
        }
        window.resize(QSize(1200, 420));
        window.show();
        wait_until_exposed(window);
    }
};

TEST(SlicePictures, show_the_ct_of_a_head) {
    if (!there_is("cthead_unc.nrrd")) GTEST_SKIP() << "needs cthead_unc.nrrd";
    const Field field = linear_field(real("cthead_unc.nrrd"));
    ThreePanes shown(field, 500, physical_centre(field.geometry()) + Vec3(30, -140, 20));
    keep_picture(shown.window, "slices_ct_head");
    const QPoint middle = shown.panes[2]->rect().center();
    QTest::mouseMove(shown.panes[2], middle + QPoint(40, 10));
    for (int i = 0; i < 8; ++i) {
        const QPoint at = shown.panes[2]->pixel_of(shown.panes[2]->crosshair()).toPoint();
        QWheelEvent zoom(at, shown.panes[2]->mapToGlobal(at), {}, {0, 120}, Qt::NoButton,
                         Qt::ControlModifier, Qt::NoScrollPhase, false);
        QApplication::sendEvent(shown.panes[2], &zoom);
    }
    keep_picture(*shown.panes[2], "slices_ct_head_zoomed");
}

TEST(SlicePictures, show_a_small_pane_under_the_pointer) {
    if (!there_is("cthead_unc.nrrd")) GTEST_SKIP() << "needs cthead_unc.nrrd";
    SlicePane pane(2);
    pane.resize(240, 260);
    pane.set_field(linear_field(real("cthead_unc.nrrd")), 500);
    pane.show();
    wait_until_exposed(pane);
    QMouseEvent move(QEvent::MouseMove, QPointF(140, 120), Qt::NoButton, Qt::NoButton,
                     Qt::NoModifier);
    QApplication::sendEvent(&pane, &move);
    keep_picture(pane, "slices_small");
}

TEST(SlicePictures, show_a_lobster) {
    if (!there_is("lobster.nrrd")) GTEST_SKIP() << "needs lobster.nrrd";
    const Field field = linear_field(real("lobster.nrrd"));
    ThreePanes shown(field, 40, physical_centre(field.geometry()) + Vec3(0, 0, 120));
    keep_picture(shown.window, "slices_lobster");
}

TEST(SlicePictures, mirrored_and_aslant_grids_show_the_same_head_in_the_same_orientation) {
    if (!there_is("cthead_unc.nrrd")) GTEST_SKIP() << "needs cthead_unc.nrrd";
    const Volume head = real("cthead_unc.nrrd");
    // The same bytes, told to run the other way: seen upside down and mirrored.
    Geometry mirrored = head.geometry();
    mirrored.direction = Vec3(-1, 1, -1).asDiagonal();
    Geometry aslant = head.geometry();
    aslant.direction = support::oblique_direction();
    for (const auto& [name, geometry] :
         {std::pair{"slices_mirrored", mirrored}, {"slices_aslant", aslant}}) {
        const auto samples = head.samples<std::uint16_t>();
        const Field field = linear_field(
            Volume(geometry, std::vector<std::uint16_t>(samples.begin(), samples.end())));
        ThreePanes shown(field, 500, physical_centre(geometry) + Vec3(20, -150, 10));
        keep_picture(shown.window, name);
    }
}

TEST(SlicePictures, show_empty_panes_and_focus_in_dark_and_light) {
    const QPalette before = QApplication::palette();
    for (const bool dark : {false, true}) {
        if (dark) {
            QPalette palette(QColor(40, 40, 40), QColor(30, 30, 30));
            palette.setColor(QPalette::Highlight, QColor(80, 140, 220));
            QApplication::setPalette(palette);
        }
        QWidget window;
        auto* layout = new QGridLayout(&window);
        auto* empty = new SlicePane(0);
        auto* full = new SlicePane(2);
        full->set_field(ball_on(support::oblique_direction()), 0.5);
        layout->addWidget(empty, 0, 0);
        layout->addWidget(full, 0, 1);
        window.resize(700, 340);
        window.show();
        QApplication::setActiveWindow(&window);
        wait_until_exposed(window);
        full->setFocus();
        keep_picture(window, dark ? "slices_dark" : "slices_light");
    }
    QApplication::setPalette(before);
}

}  // namespace
}  // namespace palpate::viewer
