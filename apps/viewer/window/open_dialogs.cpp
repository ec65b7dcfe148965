// Forms and a table, each with a preview or facts for the choice.
#include "apps/viewer/window/open_dialogs.hpp"

#include <QCheckBox>
#include <QComboBox>
#include <QCoreApplication>
#include <QDialog>
#include <QDialogButtonBox>
#include <QFileInfo>
#include <QFormLayout>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QSlider>
#include <QTableWidget>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "apps/options/exit_status.hpp"
#include "apps/viewer/model/measurement.hpp"
#include "apps/viewer/model/opening.hpp"
#include "apps/viewer/model/worker.hpp"
#include "apps/viewer/panel/form.hpp"
#include "apps/viewer/panel/inputs.hpp"
#include "apps/viewer/panel/layout.hpp"
#include "apps/viewer/scene/threads.hpp"
#include "apps/viewer/window/hints.hpp"

namespace palpate::viewer {

namespace {

constexpr int picture_side = 280;  // pixels
constexpr double most_skipped = std::numeric_limits<int>::max();

QPixmap pixmap_of(const io::Thumbnail& picture, const QSize& size) {
    if (picture.grey.empty()) return {};
    const QImage image(picture.grey.data(), picture.width, picture.height, picture.width,
                       QImage::Format_Grayscale8);
    return QPixmap::fromImage(image.scaled(size, Qt::KeepAspectRatio, Qt::SmoothTransformation));
}

/// The layout of a raw file, with a slice of it.
class RawDialog : public Form {
    Q_DECLARE_TR_FUNCTIONS(palpate::viewer::RawDialog)

  public:
    explicit RawDialog(const QString& path)
        : path_(path),
          have_(double(QFileInfo(path).size())),
          layout_(guessed_layout(path.toStdString(), static_cast<std::uint64_t>(have_))) {
        verdict_->setWordWrap(true);
        add_rows();
    }
    run::FileSource source() const {
        const bool given = layout_.spacing != Vec3::Ones();
        return {path_.toStdString(),
                layout_,
                given ? std::optional(layout_.spacing) : std::nullopt,
                {}};
    }
    QWidget* make_preview();
    bool judge();

  private:
    QWidget* make_numbers(const QString& name, const QString& spoken, auto io::RawLayout::*member,
                          double low, double high);
    void add_rows();
    bool is_packed() const { return path_.endsWith(".gz", Qt::CaseInsensitive); }
    void show_slice();

    QString path_;
    double have_;  // [bytes] of the file
    io::RawLayout layout_;
    QSlider* slice_ = named(new QSlider(Qt::Horizontal), "raw_slice");
    QLabel* picture_ = named(new QLabel, "raw_picture");
    QLabel* verdict_ = named(new QLabel, "raw_verdict");
};

/// Three numbers, along x, y and z.
QWidget* RawDialog::make_numbers(const QString& name, const QString& spoken,
                                 auto io::RawLayout::*member, double low, double high) {
    auto* row = row_of({});
    for (int a = 0; a < 3; ++a) {
        const auto get = [this, a, member] { return double((layout_.*member)[a]); };
        const auto set = [this, a, member](double to) {
            auto& one = (layout_.*member)[a];
            one = static_cast<std::decay_t<decltype(one)>>(to);
        };
        const Words words{name + QString::number(a), "", {}, spoken.arg(QChar("xyz"[a]))};
        row->layout()->addWidget(number(words, within(low, high, {get, set})));
    }
    return row;
}

void RawDialog::add_rows() {
    auto* rows = form_in(this);
    const std::vector types{SampleType::uint8, SampleType::int16, SampleType::uint16,
                            SampleType::float32};
    auto* type = choice(
        {"raw_type", ""}, {"uint8", "int16", "uint16", "float32"},
        {[this, types] { return int(std::ranges::find(types, layout_.type) - types.begin()); },
         [this, types](int at) { layout_.type = types[std::size_t(at)]; }});
    auto* order = choice(
        {"raw_order", ""}, {tr("little-endian (PC)"), tr("big-endian")},
        {[this] { return int(layout_.big_endian); }, [this](int at) { layout_.big_endian = at; }});
    each_time(order, [this](QWidget& one) { one.setEnabled(size_of(layout_.type) > 1); });
    auto* skip =
        number({"raw_skip", ""}, within(0, most_skipped,
                                        {[this] { return double(layout_.skip); },
                                         [this](double to) { layout_.skip = std::uint64_t(to); }}));
    auto* skip_rest = button(
        {"raw_skip_rest", tr("Skip the rest"),
         tr("Takes the bytes that are left over for a header")},
        [this] { layout_.skip += std::uint64_t(have_ - bytes_of(layout_)); },
        [this] { return !is_packed() && bytes_of(layout_) < have_; });
    add_row(*rows, tr("Samples"),
            make_numbers("size", tr("Samples along %1"), &io::RawLayout::size, 1, 65535),
            tr("How many along x, which runs fastest, y and z"));
    add_row(*rows, tr("Sample type"), type, tr("Of each sample in the file"));
    add_row(*rows, tr("Byte order"), order, tr("Of samples of two or four bytes"));
    add_row(*rows, tr("Spacing [mm]"),
            make_numbers("spacing", tr("Spacing along %1"), &io::RawLayout::spacing, 1e-4, 1000),
            tr("Between samples along x, y and z"));
    add_row(*rows, tr("Header [bytes]"), row_of({skip, skip_rest}),
            tr("Skipped before the samples"));
    rows->addRow(verdict_);
}

QWidget* RawDialog::make_preview() {
    picture_->setFixedSize(picture_side, picture_side);
    picture_->setAlignment(Qt::AlignCenter);
    picture_->setWordWrap(true);
    picture_->setFrameShape(QFrame::StyledPanel);
    slice_->setAccessibleName(tr("Slice of the preview"));
    connect(slice_, &QSlider::valueChanged, this, &RawDialog::show_slice);
    return column_of({picture_, slice_});
}

/// Whether the file has just the bytes that are needed; says so, and shows the middle slice.
bool RawDialog::judge() {
    const double bytes = bytes_of(layout_);
    verdict_->setText(
        is_packed() ? tr("These samples take %1 bytes once unpacked.").arg(count_text(bytes))
        : bytes == have_
            ? tr("These samples are just what the file holds.")
            : (have_ > bytes ? tr("The file holds %1 bytes, %2 more than these samples take.")
                             : tr("The file holds %1 bytes, %2 fewer than these samples take."))
                  .arg(count_text(have_), count_text(std::abs(have_ - bytes))));
    if (slice_->maximum() != layout_.size[2] - 1) {
        slice_->setMaximum(layout_.size[2] - 1);
        slice_->setValue(layout_.size[2] / 2);
    }
    show_slice();
    return is_packed() || bytes == have_;
}

void RawDialog::show_slice() {
    const auto slice = raw_slice(path_.toStdString(), layout_, slice_->value());
    if (!slice) return picture_->setText(tr("No preview"));
    picture_->setPixmap(pixmap_of(*slice, picture_->contentsRect().size()));
}

}  // namespace

QDialog* make_raw_dialog(const QString& path, QWidget* window,
                         std::function<void(const run::FileSource&)> then) {
    auto* dialog = named(new QDialog(window), "raw");
    dialog->setWindowTitle(RawDialog::tr("Raw data: %1").arg(QFileInfo(path).fileName()));
    auto* form = new RawDialog(path);
    QPushButton* accept =
        fill(*dialog, row_of({form, form->make_preview()}), QDialogButtonBox::Open);
    form->each_time(accept, [form](QPushButton& open) { open.setEnabled(form->judge()); });
    form->refresh();
    QObject::connect(dialog, &QDialog::accepted, form,
                     [form, then = std::move(then)] { then(form->source()); });
    return dialog;
}

namespace {

constexpr int picture_size = 64;

struct SeriesDialog {
    Q_DECLARE_TR_FUNCTIONS(palpate::viewer::SeriesDialog)
};

QStringList columns() {
    return {"",
            SeriesDialog::tr("Series"),
            SeriesDialog::tr("Modality"),
            SeriesDialog::tr("Slices"),
            SeriesDialog::tr("Size"),
            SeriesDialog::tr("Spacing [mm]"),
            SeriesDialog::tr("Patient"),
            SeriesDialog::tr("Study")};
}

QStringList texts_of(const io::SeriesInfo& s) {
    const auto text = [](const std::string& t) { return QString::fromStdString(t); };
    QString name = s.description.empty() ? text(s.uid) : text(s.description);
    if (!s.stack.empty()) name = SeriesDialog::tr("%1 (stack %2)").arg(name, text(s.stack));
    QStringList spacing;
    for (int a = 0; a < 3 && s.spacing[a] > 0; ++a)
        spacing << QString::number(s.spacing[a], 'g', 4);
    return {name,
            text(s.modality),
            QString::number(s.slices),
            QString("%1 x %2").arg(s.size[0]).arg(s.size[1]),
            spacing.join(" x "),
            text(s.patient).replace('^', ' ').simplified(),
            text(s.study)};
}

}  // namespace

QDialog* make_series_dialog(const QString& name, const std::vector<io::SeriesInfo>& series,
                            QWidget* window, std::function<void(int)> then) {
    auto* dialog = named(new QDialog(window), "choose-series");
    dialog->setWindowTitle(SeriesDialog::tr("Choose a series of %1").arg(name));
    auto* table =
        named(new QTableWidget(static_cast<int>(series.size()), columns().size()), "series");
    table->setAccessibleName(SeriesDialog::tr("Series"));
    table->setHorizontalHeaderLabels(columns());
    table->setSelectionBehavior(QAbstractItemView::SelectRows);
    table->setSelectionMode(QAbstractItemView::SingleSelection);
    table->setEditTriggers(QAbstractItemView::NoEditTriggers);
    for (int row = 0; row < table->rowCount(); ++row) {
        const io::SeriesInfo& s = series[static_cast<std::size_t>(row)];
        auto* picture = new QLabel;
        picture->setPixmap(pixmap_of(s.picture, {picture_size, picture_size}));
        picture->setAlignment(Qt::AlignCenter);
        table->setCellWidget(row, 0, picture);
        const QStringList texts = texts_of(s);
        for (int i = 0; i < texts.size(); ++i) {
            auto* item = new QTableWidgetItem(texts[i]);
            item->setToolTip(QString::fromStdString(s.uid));
            table->setItem(row, i + 1, item);
        }
        table->setRowHeight(row, picture_size + 6);
    }
    table->resizeColumnsToContents();
    table->setColumnWidth(0, picture_size + 10);
    // The one with the most slices is most often what is looked for.
    const auto most = std::ranges::max_element(series, {}, &io::SeriesInfo::slices);
    table->selectRow(static_cast<int>(most - series.begin()));
    QPushButton* open = fill(*dialog, table, QDialogButtonBox::Open);
    const auto chosen = [table] {
        const auto rows = table->selectionModel()->selectedRows();
        return rows.isEmpty() ? 0 : rows.front().row() + 1;
    };
    QObject::connect(table, &QTableWidget::cellDoubleClicked, dialog, &QDialog::accept);
    QObject::connect(table, &QTableWidget::itemSelectionChanged, open,
                     [open, chosen] { open->setEnabled(chosen() > 0); });
    QObject::connect(dialog, &QDialog::accepted, table,
                     [chosen, then = std::move(then)] { then(chosen()); });
    dialog->resize(900, 420);
    return dialog;
}

namespace {

QString product(const Index3& size) {
    return QString("%1 x %2 x %3").arg(size[0]).arg(size[1]).arg(size[2]);
}

QString product(const Vec3& spacing) {
    const auto number = [](double mm) { return QString::number(mm, 'g', 4); };
    return number(spacing[0]) + " x " + number(spacing[1]) + " x " + number(spacing[2]);
}

/// Attempts of a request while somebody waits for a dialog.
constexpr int most_attempts = 2;
constexpr double timeout_s = 5;

/// Written by the thread that looks.
struct Found {
    stream::StoreInfo info;
    run::StoreSource source;
    QString problem;
};

/// What is asked for a store, and what it has.
class StoreDialog : public QWidget {
    Q_DECLARE_TR_FUNCTIONS(palpate::viewer::StoreDialog)

  public:
    StoreDialog(const std::optional<run::StoreSource>& known, int time, QDialog& dialog);
    run::Source source() const;

  private:
    void add_rows();
    void look();
    void take(const std::shared_ptr<Found>& found);
    void show_found();
    void tell(const QString& verdict);

    QLineEdit* address_ = named(new QLineEdit, "store_address");
    QPushButton* look_ = named(new QPushButton(tr("Look it up")), "store_look",
                               tr("Reads which levels, channels and times there are"));
    QComboBox* level_ = named(new QComboBox, "store_level");
    QComboBox* channel_ = named(new QComboBox, "store_channel");
    NumberBox* time_ = named(new NumberBox, "store_time");
    QCheckBox* all_times_ = named(new QCheckBox(tr("All, as a sequence")), "store_all_times",
                                  tr("Plays them; each is read whole at this level"));
    QCheckBox* forbidden_ =
        named(new QCheckBox(tr("Status 403 means: not stored")), "store_forbidden",
              tr("S3 answers so for missing pieces where the list is not public"));
    QLabel* verdict_ = named(new QLabel, "store_verdict");
    QPushButton* accept_;
    int first_level_ = 0, first_channel_ = 0, first_time_;  // as they are felt now
    run::StoreSource known_;
    std::shared_ptr<Found> looking_, found_;  // asked last; what can be opened
    NewestWorker worker_;                     // that looks
};

/// "0: 512 x 512 x 234, every 1 x 1 x 2 mm, 61 MB".
QString level_words(const stream::StoreInfo& info, int level) {
    const Geometry& grid = info.levels[static_cast<std::size_t>(level)].geometry;
    const double bytes = double(sample_count(grid)) * double(size_of(info.type));
    return StoreDialog::tr("%1: %2 samples, every %3 %4, %5")
        .arg(QString::number(level), product(grid.size), product(grid.spacing),
             QCoreApplication::translate("Units", unit_word(grid)), bytes_text(bytes));
}

void StoreDialog::add_rows() {
    auto* form = form_in(this);
    address_->setPlaceholderText("https://…/image.zarr");
    address_->setMinimumWidth(60 * fontMetrics().averageCharWidth());
    add_row(*form, tr("Address"), row_of({address_, look_}, 0),
            tr("http, https or s3, or the folder or file of a volume that is read in parts"));
    add_row(*form, tr("Level"), level_,
            tr("The level of detail that is felt, and the finest that is seen; 0 is the finest"));
    add_row(*form, tr("Channel"), channel_, tr("Of an image with several"));
    time_->setDecimals(0);
    time_->setRange(0, 0);
    add_row(*form, tr("Time"), row_of({time_, all_times_}, 0),
            tr("The moment of an image with several, from 0"));
    add_row(*form, tr("Missing pieces"), forbidden_,
            tr("What a server answers for pieces that hold only the fill value"));
    form->addRow(verdict_);
    verdict_->setWordWrap(true);
    verdict_->setTextFormat(Qt::PlainText);
}

StoreDialog::StoreDialog(const std::optional<run::StoreSource>& known, int time, QDialog& dialog)
    : accept_(fill(dialog, this, QDialogButtonBox::Open)), first_time_(time) {
    add_rows();
    connect(all_times_, &QCheckBox::toggled, time_, &QWidget::setDisabled);
    connect(look_, &QPushButton::clicked, this, &StoreDialog::look);
    connect(address_, &QLineEdit::returnPressed, this, &StoreDialog::look);
    // Return in the line looks; it must not open what was found at another address.
    for (auto* button : dialog.findChildren<QPushButton*>()) button->setAutoDefault(false);
    connect(address_, &QLineEdit::textEdited, this, [this] {
        worker_.cancel();
        looking_ = found_ = nullptr;
        show_found();
    });
    if (known) {
        known_ = *known;
        first_level_ = known->loader.level;
        first_channel_ = known->options.channel;
        all_times_->setChecked(known->all_times);
        forbidden_->setChecked(known->options.forbidden_is_missing);
        address_->setText(QString::fromStdString(known->address));
        address_->setReadOnly(true);
        look();
    }
    show_found();
    if (!known) address_->setFocus();
}

void StoreDialog::look() {
    const std::string address = address_->text().trimmed().toStdString();
    if (address.empty()) return;
    const auto found = std::make_shared<Found>();
    found->source = known_;
    looking_ = found;
    found_.reset();
    show_found();
    tell(tr("Looking …"));
    worker_.start(
        [found, address, is_known = address == known_.address](const io::Progress& progress) {
            try {
                if (!is_known) {
                    // As a session keeps names: "level" says that it is a store.
                    const run::Source source =
                        run::source_from({{"volume", address}, {"level", "0"}});
                    found->source = std::get<run::StoreSource>(source.from);
                }
                stream::StoreOptions options = found->source.options;
                options.attempts = most_attempts;
                options.timeout_s = timeout_s;
                found->info = stream::open_store(address, options, progress)->info();
            } catch (const std::exception& e) {
                found->problem = QString::fromStdString(app::failure_of(e).text);
            }
        },
        [this, found] { hand_over(this, [this, found] { take(found); }); });
}

/// Unless another address was asked for since.
void StoreDialog::take(const std::shared_ptr<Found>& found) {
    if (found != looking_ || !worker_.ended()) return;
    if (found->problem.isEmpty()) found_ = found;
    show_found();
    if (!found->problem.isEmpty()) tell(found->problem);
}

/// A dialog does not grow by itself when a text needs more lines.
void StoreDialog::tell(const QString& verdict) {
    verdict_->setText(verdict);
    QWidget& dialog = *window();
    if (!dialog.isVisible()) return;  // it takes the size that it needs when it is shown
    layout()->activate();             // tells the layout of the dialog that the text has changed
    dialog.resize(dialog.width(), std::max(dialog.height(), dialog.heightForWidth(dialog.width())));
}

void StoreDialog::show_found() {
    const bool good = found_ != nullptr;
    level_->clear();
    channel_->clear();
    verdict_->clear();
    for (QWidget* field : std::initializer_list<QWidget*>{level_, channel_, time_, all_times_}) {
        field->setEnabled(good);
    }
    accept_->setEnabled(good);
    if (!good) return;
    const stream::StoreInfo& info = found_->info;
    for (int i = 0; i < static_cast<int>(info.levels.size()); ++i) {
        level_->addItem(level_words(info, i));
    }
    level_->setCurrentIndex(std::min(first_level_, level_->count() - 1));
    for (std::size_t i = 0; i < info.channels.size(); ++i) {
        const QString name = QString::fromStdString(info.channels[i]);
        channel_->addItem(name.isEmpty() ? QString::number(i) : QString("%1: %2").arg(i).arg(name));
    }
    channel_->setCurrentIndex(std::min(first_channel_, channel_->count() - 1));
    channel_->setEnabled(channel_->count() > 1);
    time_->setRange(0, std::max(0, info.times - 1));
    time_->setValue(first_time_);
    all_times_->setEnabled(info.times > 1);
    time_->setEnabled(info.times > 1 && !all_times_->isChecked());
    tell(QString::fromStdString(info.format));
    accept_->setFocus();
}

run::Source StoreDialog::source() const {
    run::StoreSource store = found_ ? found_->source : known_;
    store.loader.level = std::max(0, level_->currentIndex());
    store.options.channel = std::max(0, channel_->currentIndex());
    store.options.forbidden_is_missing = forbidden_->isChecked();
    store.all_times = time_->maximum() > 0 && all_times_->isChecked();
    // They are for volumes that are read while they are touched.
    if (store.all_times) store.loader.whole_process = store.loader.coarse_first = false;
    run::Source source;
    source.from = std::move(store);
    if (time_->maximum() > 0 && !store.all_times) source.frame = static_cast<int>(time_->value());
    return source;
}

}  // namespace

QDialog* make_store_dialog(const std::optional<run::StoreSource>& known, int time, QWidget* window,
                           std::function<void(const run::Source&)> then) {
    auto* dialog = named(new QDialog(window), "store");
    dialog->setWindowTitle(known ? StoreDialog::tr("Level, channel and time")
                                 : StoreDialog::tr("Open an address"));
    auto* fields = new StoreDialog(known, time, *dialog);
    QObject::connect(dialog, &QDialog::accepted, fields,
                     [fields, then = std::move(then)] { then(fields->source()); });
    return dialog;
}

}  // namespace palpate::viewer
