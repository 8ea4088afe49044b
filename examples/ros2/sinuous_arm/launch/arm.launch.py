"""Start the node with the problem file of the package, or with `job:=FILE`."""

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """Return what is started."""
    own = Path(get_package_share_directory("sinuous_arm")) / "config" / "arm.yaml"
    job = DeclareLaunchArgument("job", default_value=str(own))
    node = Node(package="sinuous_arm", executable="arm", name="arm", parameters=[{"job": LaunchConfiguration("job")}])
    return LaunchDescription([job, node])
