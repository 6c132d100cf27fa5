//! Perimeter of the convex hull of points in a plane, with its gradient: what a tape reads.

use glam::DVec2;

/// Indices of the hull's corners, counter-clockwise (Andrew's monotone chain, 1979).
pub(super) fn convex_hull(points: &[DVec2]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| {
        points[a].x.total_cmp(&points[b].x).then(points[a].y.total_cmp(&points[b].y)).then(a.cmp(&b))
    });
    order.dedup_by(|a, b| points[*a] == points[*b]);
    if order.len() < 3 {
        return order;
    }
    let turn = |o: usize, a: usize, b: usize| (points[a] - points[o]).perp_dot(points[b] - points[o]);
    let mut hull: Vec<usize> = Vec::with_capacity(order.len() + 1);
    for pass in 0..2 {
        let floor = hull.len() + 1;
        let mut walk = |p: usize| {
            while hull.len() > floor && turn(hull[hull.len() - 2], hull[hull.len() - 1], p) <= 0.0 {
                hull.pop();
            }
            hull.push(p);
        };
        if pass == 0 {
            order.iter().copied().for_each(&mut walk);
        } else {
            order.iter().rev().copied().for_each(&mut walk);
        }
        hull.pop();
    }
    hull
}

/// Perimeter of the convex hull and, per corner, its index in `points` and the derivative with respect to its position.
pub(super) fn hull_perimeter(points: &[DVec2]) -> (f64, Vec<(usize, DVec2)>) {
    let hull = convex_hull(points);
    let n = hull.len();
    let mut perimeter = 0.0;
    let mut gradient: Vec<(usize, DVec2)> = hull.iter().map(|&p| (p, DVec2::ZERO)).collect();
    if n < 2 {
        return (0.0, gradient);
    }
    for i in 0..n {
        let j = (i + 1) % n;
        let side = points[hull[j]] - points[hull[i]];
        let length = side.length();
        perimeter += length;
        if length > 0.0 {
            gradient[i].1 -= side / length;
            gradient[j].1 += side / length;
        }
    }
    (perimeter, gradient)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_square_with_a_dent_is_measured_across_the_dent() {
        let points =
            [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.5, 0.2), (0.0, 1.0), (0.5, 0.0)].map(DVec2::from);
        let (perimeter, gradient) = hull_perimeter(&points);
        assert!((perimeter - 4.0).abs() < 1e-15);
        assert_eq!(gradient.iter().map(|g| g.0).collect::<Vec<_>>(), [0, 1, 2, 4]);
    }

    #[test]
    fn too_few_points_do_not_panic() {
        for n in 0..3 {
            let points = vec![DVec2::ONE; n];
            assert_eq!(hull_perimeter(&points).0, 0.0);
        }
        assert_eq!(hull_perimeter(&[DVec2::ZERO, DVec2::X]).0, 2.0);
    }

    proptest! {
        // The oracle is Cauchy's formula: the perimeter of a convex curve is its mean width times pi. With 4096
        // directions its error is below (pi / 4096)^2 / 6 relative, 1e-7.
        #[test]
        fn cauchy_agrees(points in prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64), 3..60)) {
            let points: Vec<DVec2> = points.into_iter().map(DVec2::from).collect();
            let directions = 4096;
            let mut sum = 0.0;
            for k in 0..directions {
                let u = DVec2::from_angle(std::f64::consts::TAU * f64::from(k) / f64::from(directions));
                sum += points.iter().map(|p| p.dot(u)).fold(f64::NEG_INFINITY, f64::max);
            }
            let cauchy = sum * std::f64::consts::TAU / f64::from(directions);
            let (perimeter, _) = hull_perimeter(&points);
            prop_assert!((perimeter - cauchy).abs() < 1e-6 * perimeter + 1e-9, "{perimeter} {cauchy}");
        }
    }
}
