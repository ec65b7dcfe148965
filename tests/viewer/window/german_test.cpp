// The window in German: no English is left in it, mnemonics are unique, and no label is cut off.
#include <QAbstractButton>
#include <QAction>
#include <QComboBox>
#include <QDockWidget>
#include <QLabel>
#include <QLibraryInfo>
#include <QLocale>
#include <QMenu>
#include <QMenuBar>
#include <QMessageBox>
#include <QPushButton>
#include <QScrollArea>
#include <QSet>
#include <QStatusBar>
#include <QStyleOption>
#include <QTabBar>
#include <QTabWidget>
#include <QTableWidget>
#include <QToolButton>

#include <fstream>

#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/slices/plane.hpp"
#include "apps/viewer/slices/slice_pane.hpp"
#include "apps/viewer/window/open_dialogs.hpp"
#include "apps/viewer/window/preferences.hpp"
#include "apps/viewer/window/welcome.hpp"
#include "palpate/io/sample_volume.hpp"
#include "viewer/window/window_fixture.hpp"

namespace palpate::viewer::test {
namespace {

/// The words that a person can read at `widget`, with tips and those for screen readers.
QStringList words_at(const QWidget& widget) {
    QStringList words{widget.toolTip(), widget.whatsThis(), widget.accessibleName(),
                      widget.accessibleDescription(), widget.windowTitle()};
    if (const auto* label = qobject_cast<const QLabel*>(&widget)) words << label->text();
    if (const auto* button = qobject_cast<const QAbstractButton*>(&widget)) words << button->text();
    if (const auto* menu = qobject_cast<const QMenu*>(&widget)) words << menu->title();
    if (const auto* box = qobject_cast<const QAbstractSpinBox*>(&widget)) {
        words << box->property("suffix").toString();
    }
    if (const auto* box = qobject_cast<const QComboBox*>(&widget)) {
        for (int i = 0; i < box->count(); ++i) words << box->itemText(i);
    }
    if (const auto* tabs = qobject_cast<const QTabWidget*>(&widget)) {
        for (int i = 0; i < tabs->count(); ++i) words << tabs->tabText(i);
    }
    if (const auto* table = qobject_cast<const QTableWidget*>(&widget)) {
        for (int i = 0; i < table->columnCount(); ++i) {
            if (const auto* head = table->horizontalHeaderItem(i)) words << head->text();
        }
    }
    for (const QAction* action : widget.actions()) words << action->text() << action->toolTip();
    return words;
}

/// The libraries' own: devices with what they say of themselves, and layers from files.
bool is_of_a_library(const QWidget& widget) {
    constexpr const char* names[] = {"devices",      "device_options",  "device_missing",
                                     "device_model", "welcome_devices", "layers"};
    for (const char* name : names) {
        if (widget.objectName() == name) return true;
    }
    return false;
}

QSet<QString> all_words(const QWidget& top) {
    QSet<QString> all;
    QList<QWidget*> widgets = top.findChildren<QWidget*>();
    widgets << const_cast<QWidget*>(&top);
    for (const QWidget* widget : widgets) {
        if (is_of_a_library(*widget)) continue;
        for (QString text : words_at(*widget)) {
            text.remove('&');
            if (QRegExp(".*[A-Za-z]{3}.*").exactMatch(text)) all << text;
        }
    }
    return all;
}

/// Words that are the same in both languages.
bool is_international(const QString& text) {
    const QSet<QString> same{"Name",    "Rate",     "Palpate", "Maximum", "Radius",
                             "linear",  "max",      "Labels",  "Patient", "English",
                             "Deutsch", "uint8",    "int16",   "uint16",  "float32",
                             "Axial",   "Sagittal", "Viridis", "N s/mm",  "KEY=VALUE,..."};
    return same.contains(text) || text.endsWith(" – Palpate") ||
           text.contains(QRegExp("^[-0-9., x/]*(mm|mm/mm|N/mm|N s/mm|N mm/rad|N mm s/rad)?$"));
}

QString mnemonic_of(QString text) {
    text.remove("&&");
    const int at = text.indexOf('&');
    return at < 0 ? QString() : text.mid(at + 1, 1).toLower();
}

class German : public InWindow {
  protected:
    ~German() override { QLocale::setDefault(before_); }

    void open_german() {
        window_.reset();
        translation_.emplace(Language::german);
        QLocale::setDefault(QLocale(QLocale::German));
        open_window("mouse");
    }
    void feel_sample() { feel(io::sample_volume_path().string()); }
    /// The words of the window and its dialogs, with a volume and without.
    QSet<QString> words_of_all() {
        QSet<QString> all = all_words(*window_);
        feel_sample();
        wait_until_settled();
        all |= all_words(*window_);
        for (QDialog* dialog :
             {make_first_steps_dialog(window_.get()), make_shortcuts_dialog(window_.get()),
              make_about_dialog(window_.get()),
              make_preferences_dialog({}, window_.get(), [](const Preferences&) {}),
              make_raw_dialog("/data/a.raw", window_.get(), {}),
              make_series_dialog("a", {io::SeriesInfo{}}, window_.get(), {})}) {
            all |= all_words(*dialog);
            delete dialog;
        }
        return all;
    }
    void expect_unique(const QString& where, const QStringList& texts, bool each = false) {
        QMap<QString, QString> taken;
        for (const QString& text : texts) {
            const QString key = mnemonic_of(text);
            EXPECT_FALSE(each && key.isEmpty()) << text.toStdString();
            if (key.isEmpty()) continue;
            EXPECT_FALSE(taken.contains(key)) << where.toStdString() << ": " << text.toStdString()
                                              << " and " << taken[key].toStdString();
            taken[key] = text;
        }
    }
    /// Visible labels and buttons whose words have more width than they.
    QStringList cut_off() {
        QStringList cut;
        for (const QWidget* widget : window_->findChildren<QWidget*>()) {
            if (!widget->isVisible()) continue;
            const auto* label = qobject_cast<const QLabel*>(widget);
            const auto* button = qobject_cast<const QAbstractButton*>(widget);
            if (label && !label->text().isEmpty() && !label->wordWrap() &&
                label->fontMetrics().horizontalAdvance(label->text()) > label->width()) {
                cut << label->text();
            }
            const bool spoken = button && button->text().size() > 1;  // not a sign
            if (spoken && button->sizeHint().width() > button->width() + 2) cut << button->text();
            if (const QString text = cut_off_in(*widget); !text.isEmpty()) cut << text;
        }
        return cut;
    }
    /// What a number box or the choice of layers shows, if it has more width than its room.
    static QString cut_off_in(const QWidget& widget) {
        QString text;
        QRect room;
        if (const auto* box = qobject_cast<const QAbstractSpinBox*>(&widget)) {
            QStyleOptionSpinBox option;
            option.initFrom(box);
            room = box->style()->subControlRect(QStyle::CC_SpinBox, &option,
                                                QStyle::SC_SpinBoxEditField, box);
            text = box->text();
        } else if (widget.objectName() == "layers") {
            const auto& choice = *qobject_cast<const QComboBox*>(&widget);
            QStyleOptionComboBox option;
            option.initFrom(&choice);
            room = choice.style()->subControlRect(QStyle::CC_ComboBox, &option,
                                                  QStyle::SC_ComboBoxEditField, &choice);
            text = choice.currentText();
        }
        return widget.fontMetrics().horizontalAdvance(text) > room.width() ? text : QString();
    }

    std::optional<Translation> translation_;
    QLocale before_;
};

TEST_F(German, no_word_is_left_in_english) {
    const QSet<QString> english = words_of_all();
    open_german();
    const QSet<QString> german = words_of_all();
    EXPECT_GT(english.size(), 200);
    for (const QString& text : german) {
        const bool same = english.contains(text) && !is_international(text);
        EXPECT_FALSE(same) << text.toStdString();
    }
    EXPECT_TRUE(german.contains("Isofläche, die gefühlt wird") ||
                german.contains("Die Isofläche, die gefühlt wird"));
}

TEST_F(German, mnemonics_are_unique_in_every_menu) {
    open_german();
    QStringList top;
    for (const QAction* action : window_->menuBar()->actions()) top << action->text();
    const auto& tabs = part<QTabWidget>("tabs");
    for (int i = 0; i < tabs.count(); ++i) top << tabs.tabText(i);
    expect_unique("window", top, true);
    for (const QMenu* menu : window_->findChildren<QMenu*>()) {
        QStringList texts;
        for (const QAction* action : menu->actions()) texts << action->text();
        expect_unique(menu->title(), texts);
    }
}

TEST_F(German, no_label_of_the_panel_is_cut_off_at_the_usual_width) {
    open_german();
    feel_sample();
    window_->content().effect().request(command::Scale{1.26123});
    auto& tabs = part<QTabWidget>("tabs");
    for (int i = 0; i < tabs.count(); ++i) {
        tabs.setCurrentIndex(i);
        wait_until_settled();
        EXPECT_TRUE(cut_off().isEmpty()) << cut_off().join(" | ").toStdString();
        save(QString("page-%1").arg(i).toStdString());
    }
}

TEST_F(German, all_pages_of_the_panel_can_be_chosen_in_a_small_window) {
    open_german();
    window_->resize(62 * window_->fontMetrics().height(), 700);
    feel("synthetic:sphere:24x24x24");
    const QTabBar& tabs = *part<QTabWidget>("tabs").tabBar();
    wait_until_settled();
    EXPECT_LE(tabs.tabRect(tabs.count() - 1).right(), tabs.width()) << window_->width();
}

TEST_F(German, no_page_of_the_panel_is_cut_off_whatever_is_unfolded) {
    open_german();
    feel_sample();
    for (auto* heading : window_->findChildren<QToolButton*>()) {
        if (heading->objectName().endsWith("_heading")) heading->setChecked(true);
    }
    QTest::mouseClick(&part<QPushButton>("add_layer"), Qt::LeftButton);
    auto& tabs = part<QTabWidget>("tabs");
    for (int i = 0; i < tabs.count(); ++i) {
        tabs.setCurrentIndex(i);
        wait_until_settled();
        const auto& page = dynamic_cast<const QScrollArea&>(*tabs.widget(i));
        EXPECT_LE(page.widget()->minimumSizeHint().width(), page.viewport()->width()) << i;
    }
}

TEST_F(German, a_refusal_and_a_warning_are_german) {
    open_german();
    feel("synthetic:sphere:24x24x24");
    auto& stiffness = on_page<NumberBox>("stiffness_box");
    const auto type = [](NumberBox& box, const char* number) {
        box.setFocus();
        QTest::keyClick(&box, Qt::Key_A, Qt::ControlModifier);
        QTest::keyClicks(&box, number);
        QTest::keyClick(&box, Qt::Key_Return);
    };
    type(stiffness, "-1");
    EXPECT_EQ(part<QLabel>("force_part_message").text(),
              "Steifigkeit [N/mm] = -1: erlaubt ist endlich und mindestens 0");
    type(stiffness, "1e6");
    EXPECT_TRUE(part<QLabel>("force_part_message").text().contains("um stabil zu sein"));
    type(on_page<NumberBox>("isovalue_box"), "1e6");
    wait_until([&] { return part<QLabel>("isovalue_warning").text().contains("Nichts ist fest"); });
}

TEST_F(German, a_new_layer_has_a_german_name) {
    open_german();
    feel_sample();
    for (const char* name : {"Schicht 1", "Schicht 2"}) {
        QTest::mouseClick(&part<QPushButton>("add_layer"), Qt::LeftButton);
        wait_until_settled();
        QStringList names;
        for (const palpate::Layer& layer : window_->live()->settings().layers->layers) {
            names << QString::fromStdString(layer.name);
        }
        EXPECT_TRUE(names.contains(name)) << names.join(", ").toStdString();
    }
}

TEST_F(German, large_numbers_read_alike_in_every_language) {
    EXPECT_EQ(count_text(999), "999");
    EXPECT_EQ(count_text(1234567), QString::fromUtf8("1\u202f234\u202f567"));
    open_german();
    const QDialog* dialog = make_raw_dialog("/dev/null", window_.get(), {});
    EXPECT_FALSE(dialog->findChild<QLabel*>("raw_verdict")->text().contains("6,"));
    EXPECT_FALSE(dialog->findChild<QLabel*>("raw_verdict")->text().contains("6."));
}

TEST_F(German, qt_s_own_buttons_are_german) {
    if (!QFile::exists(QLibraryInfo::location(QLibraryInfo::TranslationsPath) + "/qtbase_de.qm")) {
        GTEST_SKIP() << "Qt's translations are not installed";
    }
    open_german();
    QMessageBox box(QMessageBox::Question, "Palpate", {}, QMessageBox::Cancel, window_.get());
    EXPECT_EQ(box.button(QMessageBox::Cancel)->text().remove('&'), "Abbrechen");
}

TEST_F(German, numbers_in_files_keep_their_point) {
    open_german();
    feel("synthetic:sphere:32x32x32");
    window_->content().effect().request(command::Isovalue{window_->live()->isovalue() + 0.25});
    const double level = window_->live()->isovalue();
    window_->files().save_session(scratch("session.json"));
    feel("synthetic:sphere:48x48x48");
    window_->files().open_session(scratch("session.json"));
    wait_until([&] { return window_->settled() && window_->live(); });
    EXPECT_TRUE(window_->messages().problem().isEmpty())
        << window_->messages().problem().toStdString();
    EXPECT_EQ(window_->live()->isovalue(), level);
}

TEST_F(German, the_choice_of_a_language_is_kept) {
    EXPECT_EQ(saved_preferences().language, Language::system);
    for (const Language language : {Language::german, Language::english, Language::system}) {
        Preferences preferences;
        preferences.language = language;
        save_preferences(preferences);
        EXPECT_EQ(saved_preferences().language, language);
    }
    QSettings().setValue("preferences/language", "xx");
    EXPECT_EQ(saved_preferences().language, Language::system);
}

TEST_F(German, plurals_are_right_in_both_languages) {
    const auto ticks = [](int n) {
        return QCoreApplication::translate("palpate::viewer::RecordingController",
                                           "%n ticks come out otherwise than they were recorded",
                                           nullptr, n);
    };
    {
        const Translation english(Language::english);
        EXPECT_EQ(ticks(1), "1 tick comes out otherwise than it was recorded");
        EXPECT_EQ(ticks(2), "2 ticks come out otherwise than they were recorded");
    }
    const Translation german(Language::german);
    EXPECT_EQ(ticks(1), "1 Takt fällt anders aus, als er aufgezeichnet wurde");
    EXPECT_EQ(ticks(2), "2 Takte fallen anders aus, als sie aufgezeichnet wurden");
}

TEST_F(German, lengths_are_in_Voxel_where_nothing_gives_the_spacing) {
    std::ofstream(scratch_.path() / "a.nrrd", std::ios::binary)
        << "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n\n"
        << std::string(32, '\0') << std::string(32, '\xff');
    open_german();
    feel(scratch("a.nrrd").toStdString());
    SlicePane& pane = window_->views().slice(2);
    measure(pane);
    EXPECT_TRUE(window_->statusBar()->currentMessage().endsWith(" Voxel"));
    wait_until([&] {
        return part<QLabel>("contact").text().contains(" Voxel im Vol") &&
               part<QLabel>("readout").text().endsWith("/Voxel");
    });
    const SlicePlane plane = slice_plane(window_->live()->field().geometry(), 2);
    EXPECT_TRUE(QString::fromStdString(position_text(plane, Vec3::Constant(3))).endsWith(" Voxel"));
}

}  // namespace
}  // namespace palpate::viewer::test
