// SPDX-License-Identifier: BSD-3-Clause
#include "plot_view.h"

#include <QVBoxLayout>
#include <qwt_legend.h>
#include <qwt_plot.h>
#include <qwt_plot_curve.h>

#include "plain_text.h"

namespace soft_robot_lab {
namespace {

// Distinct for the colour-blind too (Okabe and Ito 2008).
QColor colour(std::size_t number) {
  static const QColor colours[] = {QColor(0, 114, 178),   QColor(213, 94, 0),  QColor(0, 158, 115),
                                   QColor(204, 121, 167), QColor(230, 159, 0), QColor(86, 180, 233)};
  return colours[number % (sizeof colours / sizeof *colours)];
}

QVector<QPointF> points_of(const History::Points& points, double now_s) {
  QVector<QPointF> all;
  for (const auto& [time_s, value] : points) all.append(QPointF(time_s - now_s, value));
  return all;
}

}  // namespace

PlotView::PlotView(QWidget* parent) : QWidget(parent), title_(new QComboBox(this)), plot_(new QwtPlot(this)) {
  connect(title_, QOverload<const QString&>::of(&QComboBox::textActivated), this,
          [this](const QString& title) { wanted_ = title; });
  title_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  title_->setMinimumContentsLength(16);
  title_->setToolTip("What is plotted, over the last 20 s of the session");
  plot_->setAxisScale(QwtPlot::xBottom, -History::kept_s, 0.0, 5.0);
  plot_->setMinimumHeight(150);
  plot_->setCanvasBackground(Qt::white);
  plot_->insertLegend(new QwtLegend, QwtPlot::RightLegend);
  QFont small = font();
  small.setPointSizeF(0.8 * small.pointSizeF());
  for (const int axis : {QwtPlot::xBottom, QwtPlot::yLeft}) plot_->setAxisFont(axis, small);
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->addWidget(plot_);
}

void PlotView::offer(const History& history) {
  QStringList titles, offered;
  for (const std::string& title : history.titles()) titles << QString::fromStdString(title);
  for (int i = 0; i < title_->count(); ++i) offered << title_->itemText(i);
  if (titles == offered) return;
  title_->clear();
  title_->addItems(titles);
  title_->setCurrentIndex(std::max(0, titles.indexOf(wanted_)));
}

QwtPlotCurve* PlotView::curve(const std::string& name) {
  const auto found = curves_.find(name);
  if (found != curves_.end()) return found->second;
  auto* made = new QwtPlotCurve(plain_title(QString::fromStdString(name)));
  made->setPen(colour(curves_.size()), 1.5);
  made->setRenderHint(QwtPlotItem::RenderAntialiased);
  made->attach(plot_);
  return curves_[name] = made;
}

void PlotView::show_history(const History& history) {
  if (!isVisible()) return;
  offer(history);
  const std::string title = title_->currentText().toStdString();
  if (title != shown_) {
    plot_->detachItems();
    curves_.clear();
    shown_ = title;
  }
  const History::Curves& shown = history.curves(title);
  for (auto old = curves_.begin(); old != curves_.end();) {  // of a robot that is gone
    if (shown.count(old->first) > 0) {
      ++old;
      continue;
    }
    delete old->second;  // which detaches it
    old = curves_.erase(old);
  }
  for (const auto& [name, points] : shown) curve(name)->setSamples(points_of(points, history.now_s()));
  const auto [least, greatest] = history.range(title);
  const double margin = 0.05 * (greatest - least);
  plot_->setAxisScale(QwtPlot::yLeft, least - margin, greatest + margin);
  plot_->replot();
}

}  // namespace soft_robot_lab
