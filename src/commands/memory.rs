//! The memory that there is, and the refusal of work that does not fit into it.

use metrolight::render::{Memory, Settings};
use metrolight::scene::{SceneDescription, ShapeGeometry};
use miette::bail;
use sysinfo::System;

use super::numbers::quantity;

/// Fails if a render of `pixels` pixels, and `more` bytes, do not fit into the memory that is available.
pub fn check(settings: &Settings, pixels: u64, more: u64) -> miette::Result<()> {
    let memory = Memory::of(settings, pixels);
    let needed = memory.total().saturating_add(more);
    let available = available();
    if needed <= available {
        return Ok(());
    }
    let bytes = |bytes: u64| format!("{}B", quantity(bytes as f64));
    let mut parts = vec![format!("film {}", bytes(memory.film.saturating_add(more)))];
    let mut advice = vec!["a smaller --size"];
    if memory.errors > 0 {
        parts.push(format!("standard errors {}", bytes(memory.errors)));
        advice.push("no --error");
    }
    if memory.chains > 0 {
        parts.push(format!("chains and bootstrap {}", bytes(memory.chains)));
        advice.push("fewer --chains or --bootstrap samples");
    }
    bail!(
        "this needs {} of memory ({}), and {} are available: ask for {}",
        bytes(needed),
        parts.join(", "),
        bytes(available),
        advice.join(", ")
    )
}

/// Fails if `needed` bytes for `what` are more than the memory that is available.
pub fn check_images(what: &str, needed: u64) -> miette::Result<()> {
    let available = available();
    if needed > available {
        bail!(
            "{what} need {}B of memory, and {}B are available: ask for a smaller --size or --max-depth",
            quantity(needed as f64),
            quantity(available as f64)
        );
    }
    Ok(())
}

/// Fails if the acceleration structure of a scene does not fit into the memory that is available.
pub fn check_scene(scene: &SceneDescription) -> miette::Result<()> {
    /// Bytes of a triangle while the tree is built: the triangle, a binary tree, and the final one.
    const TRIANGLE: u64 = 300;
    let triangles = scene.shapes.iter().map(|shape| match &shape.geometry {
        ShapeGeometry::Mesh(mesh) => mesh.triangles.len() as u64,
        ShapeGeometry::Sphere { .. } => 1,
    });
    let triangles: u64 = triangles.sum();
    let (needed, available) = (triangles.saturating_mul(TRIANGLE), available());
    if needed > available {
        bail!(
            "the scene has {triangles} triangles and spheres, whose acceleration structure needs about {}B of \
             memory, and {}B are available",
            quantity(needed as f64),
            quantity(available as f64)
        );
    }
    Ok(())
}

/// Bytes that this process can still use: of the machine, of its control group, and within its limits.
pub fn available() -> u64 {
    let mut system = System::new();
    system.refresh_memory();
    // Pages of files that are cached count as free: they make room when memory is short.
    let group = system.cgroup_limits();
    let group = group.map(|limits| limits.total_memory.saturating_sub(limits.rss));
    // 0 where the system does not say.
    let machine = Some(system.available_memory()).filter(|&bytes| bytes > 0);
    let limits = [machine, group, platform::limit()];
    limits.into_iter().flatten().min().unwrap_or(u64::MAX)
}

#[cfg(unix)]
mod platform {
    use std::fs;

    use rustix::process::{Resource, getrlimit};

    /// Bytes that the limit on the address space leaves (`ulimit -v`), if there is one.
    pub fn limit() -> Option<u64> {
        let limit = getrlimit(Resource::As).current?;
        Some(limit.saturating_sub(used().unwrap_or(0)))
    }

    /// Bytes of address space in use (proc_pid_status(5)); known only under Linux.
    fn used() -> Option<u64> {
        let status = fs::read_to_string("/proc/self/status").ok()?;
        let size = status
            .lines()
            .find_map(|line| line.strip_prefix("VmSize:"))?;
        let kilobytes: u64 = size.trim().strip_suffix("kB")?.trim().parse().ok()?;
        Some(kilobytes << 10)
    }
}

#[cfg(not(unix))]
mod platform {
    pub fn limit() -> Option<u64> {
        None
    }
}

/// From now on, memory that cannot be allocated ends the process with `exit_code`: the runtime says how much was
/// asked for, and aborts.
#[cfg(unix)]
pub fn exit_if_exhausted(exit_code: u8) {
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;

    use signal_hook::consts::SIGABRT;
    use signal_hook::flag::register_conditional_shutdown;

    let always = Arc::new(AtomicBool::new(true));
    // Fails only for signals that cannot be handled.
    let _ = register_conditional_shutdown(SIGABRT, exit_code.into(), always);
}

#[cfg(not(unix))]
pub fn exit_if_exhausted(_: u8) {}
