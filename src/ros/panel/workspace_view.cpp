// SPDX-License-Identifier: BSD-3-Clause
#include "workspace_view.h"

#include <algorithm>
#include <utility>

#include <QGridLayout>
#include <QSignalBlocker>
#include <qwt_color_map.h>
#include <qwt_picker_machine.h>
#include <qwt_plot.h>
#include <qwt_plot_canvas.h>
#include <qwt_plot_curve.h>
#include <qwt_plot_marker.h>
#include <qwt_plot_picker.h>
#include <qwt_plot_rescaler.h>
#include <qwt_plot_spectrocurve.h>
#include <qwt_scale_widget.h>
#include <qwt_symbol.h>
#include <qwt_text.h>

#include "geometry/convex_hull.h"
#include "plain_text.h"
#include "ros/display/plasma.h"

namespace soft_robot_lab {
namespace {

constexpr double reach_px = 20.0;  // a click farther off means no point

const int views[3][2] = {{0, 2}, {1, 2}, {0, 1}};

QwtLinearColorMap* colour_map() {
  const auto colour = [](double fraction) {
    const auto [red, green, blue] = plasma(fraction);
    return QColor::fromRgbF(red, green, blue);
  };
  auto* map = new QwtLinearColorMap(colour(0.0), colour(1.0));
  for (const double fraction : {0.25, 0.5, 0.75}) map->addColorStop(fraction, colour(fraction));
  return map;
}

void add_cloud(const QVector<QwtPoint3D>& points, double largest, QwtPlot* plot) {
  auto* cloud = new QwtPlotSpectroCurve;
  cloud->setColorMap(colour_map());
  cloud->setColorRange(QwtInterval(0.0, largest));
  cloud->setPenWidth(5.0);
  cloud->setSamples(points);
  cloud->attach(plot);
}

void add_hull(const QVector<QPointF>& corners, QwtPlot* plot) {
  auto* hull = new QwtPlotCurve;
  hull->setPen(QColor(110, 110, 110), 1.0);
  hull->setRenderHint(QwtPlotItem::RenderAntialiased);
  hull->setSamples(corners);
  hull->attach(plot);
}

void add_crosses(const QVector<QPointF>& places, QwtPlot* plot) {
  auto* crosses = new QwtPlotCurve;
  crosses->setStyle(QwtPlotCurve::NoCurve);
  crosses->setSymbol(new QwtSymbol(QwtSymbol::XCross, Qt::NoBrush, QPen(Qt::black, 1.0), QSize(7, 7)));
  crosses->setSamples(places);
  crosses->attach(plot);
}

void add_ring(const Eigen::Vector2d& place, QwtPlot* plot) {
  auto* ring = new QwtPlotMarker;
  ring->setSymbol(new QwtSymbol(QwtSymbol::Ellipse, Qt::NoBrush, QPen(QColor(213, 94, 0), 2.5), QSize(13, 13)));
  ring->setValue(place.x(), place.y());
  ring->attach(plot);
}

}  // namespace

WorkspaceView::WorkspaceView(Shown shown, std::function<void(const ReachableTip&)> chosen, QWidget* parent)
    : QWidget(parent),
      shown_(std::move(shown)),
      chosen_(std::move(chosen)),
      find_(new QPushButton("F&ind tips", this)),
      view_(new QComboBox(this)),
      colour_(new QComboBox(this)),
      number_(new QSpinBox(this)),
      state_(plain_label("Where does the marker reach?", this)),
      plot_(new QwtPlot(this)),
      search_({[this](bool runs) { find_->setText(runs ? "Stop f&inding" : "F&ind tips"); },
               [this](const QString& text) { state_->setText(text); },
               [this](ReachableTips tips) { take(std::move(tips)); }}) {
  find_->setToolTip("Finds where the marker rests over all commands, beside the session; goes on from what is there");
  view_->addItems({"x, z", "y, z", "x, y"});
  view_->setToolTip("Axes of robot_base that are seen [mm]");
  colour_->setToolTip(
      "What colours mean. Least motion: by the commands' whole range in the direction in which they move the tip "
      "least");
  number_->setToolTip("A tip by its number. Or click at one: the ghost shows how it is reached, Execute goes there");
  auto* label = plain_label("Poi&nt", this);
  label->setBuddy(number_);
  state_->setWordWrap(true);
  auto* grid = new QGridLayout(this);
  grid->setContentsMargins(0, 0, 0, 0);
  grid->setSpacing(2);
  grid->addWidget(find_, 0, 0);
  grid->addWidget(view_, 0, 1);
  grid->addWidget(colour_, 0, 2);
  grid->addWidget(label, 0, 3);
  grid->addWidget(number_, 0, 4);
  grid->addWidget(plot_, 1, 0, 1, 5);
  grid->addWidget(state_, 2, 0, 1, 5);
  plot_->setMinimumHeight(90);
  plot_->setCanvasBackground(Qt::white);
  QFont small = font();
  small.setPointSizeF(0.8 * small.pointSizeF());
  for (const int axis : {QwtPlot::xBottom, QwtPlot::yLeft, QwtPlot::yRight}) plot_->setAxisFont(axis, small);
  auto* picker = new QwtPlotPicker(plot_->canvas());
  picker->setStateMachine(new QwtPickerClickPointMachine);
  rescaler_ = new QwtPlotRescaler(plot_->canvas(), QwtPlot::xBottom, QwtPlotRescaler::Fitting);
  rescaler_->setExpandingDirection(QwtPlotRescaler::ExpandBoth);
  rescaler_->setAspectRatio(QwtPlot::yLeft, 1.0);  // a millimetre is as long both ways
  rescaler_->setAspectRatio(QwtPlot::yRight, 0.0);
  connect(picker, QOverload<const QPointF&>::of(&QwtPlotPicker::selected), this,
          [this](const QPointF& place) { choose_nearest(place); });
  connect(find_, &QPushButton::clicked, this, [this] { search_.toggle(); });
  connect(view_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, [this] { show_tips(); });
  connect(colour_, QOverload<int>::of(&QComboBox::activated), this, [this] {
    wanted_colour_ = colour_->currentText();
    recolour();
  });
  connect(number_, QOverload<int>::of(&QSpinBox::valueChanged), this, [this](int number) { choose(number); });
  take({});
}

void WorkspaceView::follow(const QString& scene, const QString& marker, int actuators) {
  const bool another = search_.follow(scene, marker, actuators);
  find_->setEnabled(search_.possible());
  if (!another) return;
  state_->setText("Where does the marker reach?");
  take({});
}

// The colours mean what was chosen, where they can.
void WorkspaceView::take(ReachableTips tips) {
  tips_ = std::move(tips);
  quantities_ = quantities_of(tips_);
  colour_->clear();
  for (const TipQuantity& quantity : quantities_) colour_->addItem(QString::fromStdString(quantity.label));
  colour_->setCurrentText(wanted_colour_);
  recolour();
}

const TipQuantity& WorkspaceView::coloured_by() const {
  return quantities_[static_cast<std::size_t>(colour_->currentIndex())];
}

void WorkspaceView::recolour() {
  shown_(tips_, coloured_by());
  show_tips();
}

Eigen::Vector2d WorkspaceView::seen_mm(const ReachableTip& tip) const {
  const int* axes = views[view_->currentIndex()];
  return 1e3 * Eigen::Vector2d(tip.position_m[axes[0]], tip.position_m[axes[1]]);
}

void WorkspaceView::show_tips() {
  const int count = static_cast<int>(tips_.tips.size());
  {
    const QSignalBlocker quiet(number_);
    number_->setRange(0, count);
    number_->setSpecialValueText("none");
    number_->setEnabled(count > 0);
  }
  plot_->detachItems();
  std::vector<Eigen::Vector2d> places;
  QVector<QwtPoint3D> cloud;
  QVector<QPointF> snaps, corners;
  const TipQuantity& quantity = coloured_by();
  for (std::size_t i = 0; i < tips_.tips.size(); ++i) {
    places.push_back(seen_mm(tips_.tips[i]));
    cloud << QwtPoint3D(places.back().x(), places.back().y(), quantity.values[i]);
    if (tips_.tips[i].snaps) snaps << QPointF(places.back().x(), places.back().y());
  }
  for (const std::size_t i : convex_hull(places)) corners << QPointF(places[i].x(), places[i].y());
  if (!corners.isEmpty()) corners << corners.first();
  const double largest = quantity.largest();
  plot_->enableAxis(QwtPlot::yRight, count > 0);
  plot_->setAxisScale(QwtPlot::yRight, 0.0, largest);
  QwtText title = plain_title(QString::fromStdString(quantity.label));
  title.setFont(plot_->axisFont(QwtPlot::yRight));
  plot_->setAxisTitle(QwtPlot::yRight, title);
  plot_->axisWidget(QwtPlot::yRight)->setColorBarEnabled(true);
  plot_->axisWidget(QwtPlot::yRight)->setColorMap(QwtInterval(0.0, largest), colour_map());
  add_hull(corners, plot_);
  add_cloud(cloud, largest, plot_);
  add_crosses(snaps, plot_);
  const int chosen = number_->value();
  if (chosen > 0 && chosen <= count) add_ring(places[static_cast<std::size_t>(chosen - 1)], plot_);
  if (count > 0)
    state_->setText(QString("%1 tips, %2 where the body snaps (crosses). Click at one.").arg(count).arg(snaps.size()));
  frame(places);
  plot_->replot();
}

void WorkspaceView::frame(const std::vector<Eigen::Vector2d>& places) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& place : places) box.extend(place);
  if (box.isEmpty()) box.extend(Eigen::Vector2d::Zero());
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(0.05 * box.sizes().maxCoeff() + 1.0);
  rescaler_->setIntervalHint(QwtPlot::xBottom, QwtInterval(box.min().x() - margin.x(), box.max().x() + margin.x()));
  rescaler_->setIntervalHint(QwtPlot::yLeft, QwtInterval(box.min().y() - margin.y(), box.max().y() + margin.y()));
  rescaler_->rescale();
}

void WorkspaceView::choose(int number) {
  show_tips();
  if (number > 0 && number <= static_cast<int>(tips_.tips.size()))
    chosen_(tips_.tips[static_cast<std::size_t>(number - 1)]);
}

void WorkspaceView::choose_nearest(const QPointF& place_mm) {
  const auto pixel = [&](double x, double y) {
    return Eigen::Vector2d(plot_->transform(QwtPlot::xBottom, x), plot_->transform(QwtPlot::yLeft, y));
  };
  const Eigen::Vector2d click = pixel(place_mm.x(), place_mm.y());
  double nearest_px = reach_px;
  int number = 0;
  for (std::size_t i = 0; i < tips_.tips.size(); ++i) {
    const Eigen::Vector2d at = seen_mm(tips_.tips[i]);
    const double distance_px = (pixel(at.x(), at.y()) - click).norm();
    if (distance_px >= nearest_px) continue;
    nearest_px = distance_px;
    number = static_cast<int>(i) + 1;
  }
  if (number > 0 && number == number_->value()) return choose(number);
  if (number > 0) number_->setValue(number);
}

}  // namespace soft_robot_lab
